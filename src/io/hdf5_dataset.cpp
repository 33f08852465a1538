#include <algorithm>
#include <filesystem>
#include <limits>
#include <numeric>

#include "elrom/base/text.hpp"
#include "hdf5_internal.hpp"

namespace elrom::io {

using namespace detail;

std::string text_of(const Shape& shape) {
  std::vector<std::string> parts;
  for (const auto size : shape) parts.push_back(std::to_string(size));
  return parts.empty() ? "scalar" : base::join(parts, " x ");
}

namespace {

constexpr std::size_t dataset_most = std::numeric_limits<std::size_t>::max();

std::size_t product(const Shape& shape) {
  std::size_t n = 1;
  for (const auto size : shape) {
    if (size != 0 && n > dataset_most / size) return dataset_most;
    n *= size;
  }
  return n;
}

void expect_numeric(hid_t dataset, const std::string& where) {
  const Hdf5Id type(readable(H5Dget_type(dataset), "cannot read dataset", where));
  const auto kind = H5Tget_class(type.get());
  if (kind != H5T_INTEGER && kind != H5T_FLOAT) {
    throw InputError({.what = "dataset is not numeric", .where = where, .expected = "integers or reals"});
  }
}

// A few bytes can claim any shape. Deflate shrinks at most
// about a thousandfold, so a larger claim is no real file.
void expect_plausible(hid_t dataset, std::size_t n, std::size_t bytes_each, const std::string& where) {
  constexpr std::size_t always_fine = std::size_t{1} << 26;
  constexpr std::size_t most_packed = 1100;
  if (n <= always_fine / bytes_each) return;
  const auto stored = static_cast<std::size_t>(H5Dget_storage_size(dataset));
  if (n / most_packed <= stored / bytes_each) return;
  throw InputError(
      {.what = "dataset claims more values than it holds", .where = where, .found = std::to_string(n)});
}

struct Selection {
  Hdf5Id file, memory;
};

Selection select(hid_t dataset, const Shape& offset, const Shape& count, const std::string& where) {
  const std::vector<hsize_t> begin(offset.begin(), offset.end()), size(count.begin(), count.end());
  Selection selection{Hdf5Id(readable(H5Dget_space(dataset), "cannot read shape", where)),
                      Hdf5Id(H5Screate_simple(static_cast<int>(size.size()), size.data(), nullptr))};
  const int rank = H5Sget_simple_extent_ndims(selection.file.get());
  if (rank != static_cast<int>(offset.size()) || offset.size() != count.size()) {
    throw InputError({.what = "wrong rank",
                      .where = where,
                      .found = std::to_string(rank),
                      .expected = std::to_string(offset.size())});
  }
  readable(
      H5Sselect_hyperslab(selection.file.get(), H5S_SELECT_SET, begin.data(), nullptr, size.data(), nullptr),
      "cannot select", where);
  if (H5Sselect_valid(selection.file.get()) <= 0) {
    throw InputError({.what = "selection lies outside the dataset", .where = where});
  }
  return selection;
}

}  // namespace

Hdf5Storage Hdf5Storage::packed(const Shape& shape, int level) {
  constexpr std::size_t most_values = std::size_t{1} << 20;
  Hdf5Storage storage{.chunk = shape, .deflate = level, .shuffle = true, .fletcher32 = true};
  for (auto& size : storage.chunk) size = std::max<std::size_t>(size, 1);
  for (auto& size : storage.chunk) {
    const auto n = product(storage.chunk);
    if (n > most_values) size = std::max<std::size_t>(1, size / ((n + most_values - 1) / most_values));
  }
  return storage;
}

Shape Hdf5Dataset::shape() const {
  const Hdf5Id space(readable(H5Dget_space(id()), "cannot read shape", where_));
  const int rank = H5Sget_simple_extent_ndims(space.get());
  if (rank < 0) throw InputError({.what = "dataset without a shape", .where = where_});
  std::vector<hsize_t> sizes(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space.get(), sizes.data(), nullptr);
  return Shape(sizes.begin(), sizes.end());
}

void Hdf5Dataset::expect_shape(const Shape& expected) const {
  const auto found = shape();
  const bool fits = std::equal(found.begin(), found.end(), expected.begin(), expected.end(),
                               [](std::size_t a, std::size_t b) { return b == 0 || a == b; });
  if (fits) return;
  std::vector<std::string> parts;
  for (const auto size : expected) parts.push_back(size == 0 ? "any" : std::to_string(size));
  throw InputError({.what = "wrong shape",
                    .where = where_,
                    .found = text_of(found),
                    .expected = base::join(parts, " x ")});
}

template <class T>
std::vector<T> Hdf5Dataset::read() const {
  const auto n = product(shape());
  expect_plausible(id(), n, sizeof(T), where_);
  std::vector<T> values(n);
  read_into(std::span<T>(values));
  return values;
}

template <class T>
void Hdf5Dataset::read_into(std::span<T> values) const {
  const auto n = product(shape());
  if (n != values.size()) {
    throw InputError({.what = "wrong number of values",
                      .where = where_,
                      .found = std::to_string(n),
                      .expected = std::to_string(values.size())});
  }
  if (n == 0) return;
  expect_numeric(id(), where_);
  readable(H5Dread(id(), native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
           "cannot read dataset", where_);
}

template <class T>
void Hdf5Dataset::read_slab(const Shape& offset, const Shape& count, std::span<T> values) const {
  check(product(count) == values.size(), "slab and buffer differ in size");
  expect_numeric(id(), where_);
  const auto selection = select(id(), offset, count, where_);
  readable(H5Dread(id(), native_type<T>(), selection.memory.get(), selection.file.get(), H5P_DEFAULT,
                   values.data()),
           "cannot read dataset", where_);
}

std::vector<std::string> Hdf5Dataset::read_texts() const {
  const Hdf5Id type(readable(H5Dget_type(id()), "cannot read dataset", where_));
  const Hdf5Id space(readable(H5Dget_space(id()), "cannot read dataset", where_));
  const auto text = text_type_of(type.get(), where_);
  const auto n = product(shape());
  expect_plausible(id(), n, std::max(text.size, sizeof(char*)), where_);
  return unpack_texts(text, space.get(), n, [&](hid_t memory_type, void* data) {
    readable(H5Dread(id(), memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), "cannot read dataset", where_);
  });
}

template <class T>
void Hdf5Dataset::write(std::span<const T> values) const {
  check(product(shape()) == values.size(), "dataset and values differ in size");
  if (values.empty()) return;
  writable(H5Dwrite(id(), native_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()),
           "cannot write dataset", where_);
}

template <class T>
void Hdf5Dataset::write_slab(const Shape& offset, const Shape& count, std::span<const T> values) const {
  check(product(count) == values.size(), "slab and values differ in size");
  const auto selection = select(id(), offset, count, where_);
  writable(H5Dwrite(id(), native_type<T>(), selection.memory.get(), selection.file.get(), H5P_DEFAULT,
                    values.data()),
           "cannot write dataset", where_);
}

void Hdf5Dataset::extend(std::size_t first) const {
  const auto old = shape();
  std::vector<hsize_t> sizes(old.begin(), old.end());
  check(!sizes.empty(), "a scalar cannot be extended");
  sizes[0] = first;
  writable(H5Dset_extent(id(), sizes.data()), "cannot extend dataset", where_);
}

#define ELROM_HDF5_TYPE(T)                                                                 \
  template std::vector<T> Hdf5Dataset::read<T>() const;                                    \
  template void Hdf5Dataset::read_into<T>(std::span<T>) const;                             \
  template void Hdf5Dataset::read_slab<T>(const Shape&, const Shape&, std::span<T>) const; \
  template void Hdf5Dataset::write<T>(std::span<const T>) const;                           \
  template void Hdf5Dataset::write_slab<T>(const Shape&, const Shape&, std::span<const T>) const;
ELROM_HDF5_TYPE(float)
ELROM_HDF5_TYPE(double)
ELROM_HDF5_TYPE(std::int32_t)
ELROM_HDF5_TYPE(std::int64_t)
ELROM_HDF5_TYPE(std::uint8_t)
#undef ELROM_HDF5_TYPE

}  // namespace elrom::io
