// Identifiers and attributes.
#include <utility>

#include "hdf5_internal.hpp"

namespace elrom::io {

using namespace detail;

Hdf5Id& Hdf5Id::operator=(Hdf5Id&& other) noexcept {
  if (this != &other) {
    reset();
    id_ = other.release();
  }
  return *this;
}

void Hdf5Id::reset() noexcept {
  if (id_ < 0) return;
  quiet();
  const hid_t id = release();
  switch (H5Iget_type(id)) {
    case H5I_FILE:
      H5Fclose(id);
      break;
    case H5I_GROUP:
      H5Gclose(id);
      break;
    case H5I_DATASET:
      H5Dclose(id);
      break;
    case H5I_DATATYPE:
      H5Tclose(id);
      break;
    case H5I_DATASPACE:
      H5Sclose(id);
      break;
    case H5I_ATTR:
      H5Aclose(id);
      break;
    case H5I_GENPROP_LST:
      H5Pclose(id);
      break;
    default:
      break;
  }
}

std::int64_t Hdf5Id::release() noexcept { return std::exchange(id_, -1); }

namespace {

struct Attribute {
  Hdf5Id id, type, space;
  std::size_t n = 0;
};

Attribute open_attribute(hid_t object, const std::string& name, const std::string& where) {
  if (H5Aexists(object, name.c_str()) <= 0) {
    throw InputError({.what = "missing attribute '" + name + "'", .where = where});
  }
  Attribute attribute;
  attribute.id = Hdf5Id(readable(H5Aopen(object, name.c_str(), H5P_DEFAULT), "cannot open attribute", where));
  attribute.type = Hdf5Id(readable(H5Aget_type(attribute.id.get()), "cannot read attribute", where));
  attribute.space = Hdf5Id(readable(H5Aget_space(attribute.id.get()), "cannot read attribute", where));
  const auto n = H5Sget_simple_extent_npoints(attribute.space.get());
  constexpr hssize_t most = 1 << 20;
  if (n < 0 || n > most) {
    throw InputError(
        {.what = "attribute '" + name + "' is too large", .where = where, .found = std::to_string(n)});
  }
  attribute.n = static_cast<std::size_t>(n);
  return attribute;
}

void write_attribute(const Hdf5Object& object, const std::string& name, hid_t file_type, hid_t memory_type,
                     hid_t space, const void* data) {
  object.remove_attribute(name);
  const Hdf5Id attribute(
      writable(H5Acreate2(object.id(), name.c_str(), file_type, space, H5P_DEFAULT, H5P_DEFAULT),
               "cannot create attribute '" + name + "'", object.where()));
  writable(H5Awrite(attribute.get(), memory_type, data), "cannot write attribute '" + name + "'",
           object.where());
}

Hdf5Id line_of(std::size_t n) {
  const hsize_t size = n;
  return Hdf5Id(H5Screate_simple(1, &size, nullptr));
}

}  // namespace

bool Hdf5Object::has_attribute(const std::string& name) const { return H5Aexists(id(), name.c_str()) > 0; }

void Hdf5Object::remove_attribute(const std::string& name) const {
  if (has_attribute(name))
    writable(H5Adelete(id(), name.c_str()), "cannot replace attribute '" + name + "'", where_);
}

std::vector<std::string> Hdf5Object::texts(const std::string& name) const {
  const auto attribute = open_attribute(id(), name, where_);
  const auto text = text_type_of(attribute.type.get(), where_ + " attribute '" + name + "'");
  return unpack_texts(text, attribute.space.get(), attribute.n, [&](hid_t type, void* data) {
    readable(H5Aread(attribute.id.get(), type, data), "cannot read attribute '" + name + "'", where_);
  });
}

std::string Hdf5Object::text(const std::string& name) const {
  const auto values = texts(name);
  if (values.size() != 1) {
    throw InputError({.what = "attribute '" + name + "' is not one text",
                      .where = where_,
                      .found = std::to_string(values.size()) + " values"});
  }
  return values.front();
}

std::vector<double> Hdf5Object::numbers(const std::string& name) const {
  const auto attribute = open_attribute(id(), name, where_);
  const auto kind = H5Tget_class(attribute.type.get());
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) {
    throw InputError({.what = "attribute '" + name + "' is not a number", .where = where_});
  }
  std::vector<double> values(attribute.n);
  if (values.empty()) return values;
  readable(H5Aread(attribute.id.get(), H5T_NATIVE_DOUBLE, values.data()),
           "cannot read attribute '" + name + "'", where_);
  return values;
}

double Hdf5Object::number(const std::string& name) const {
  const auto values = numbers(name);
  if (values.size() != 1) {
    throw InputError({.what = "attribute '" + name + "' is not one number",
                      .where = where_,
                      .found = std::to_string(values.size()) + " values"});
  }
  return values.front();
}

void Hdf5Object::set_text(const std::string& name, std::string_view value) const {
  const std::string text(value);
  const auto block = pack_texts({&text, 1});
  const Hdf5Id scalar(H5Screate(H5S_SCALAR));
  write_attribute(*this, name, block.type.get(), block.type.get(), scalar.get(), block.bytes.data());
}

void Hdf5Object::set_texts(const std::string& name, const std::vector<std::string>& values) const {
  const auto block = pack_texts(values);
  const auto space = line_of(values.size());
  write_attribute(*this, name, block.type.get(), block.type.get(), space.get(), block.bytes.data());
}

void Hdf5Object::set_number(const std::string& name, double value) const {
  const Hdf5Id scalar(H5Screate(H5S_SCALAR));
  write_attribute(*this, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, scalar.get(), &value);
}

void Hdf5Object::set_integer(const std::string& name, std::int64_t value) const {
  const Hdf5Id scalar(H5Screate(H5S_SCALAR));
  write_attribute(*this, name, H5T_STD_I64LE, H5T_NATIVE_INT64, scalar.get(), &value);
}

void Hdf5Object::set_integers(const std::string& name, std::span<const std::int64_t> values) const {
  const auto space = line_of(values.size());
  write_attribute(*this, name, H5T_STD_I64LE, H5T_NATIVE_INT64, space.get(), values.data());
}

}  // namespace elrom::io
