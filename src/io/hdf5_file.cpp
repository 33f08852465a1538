// Files and groups.
#include <algorithm>
#include <cerrno>
#include <cstring>

#include "elrom/base/text.hpp"
#include "hdf5_internal.hpp"

namespace elrom::io {

using namespace detail;

namespace {

// Made once and kept: a property list costs more than the small dataset it describes.
hid_t untimed(hid_t property_class) {
  const hid_t list = H5Pcreate(property_class);
  H5Pset_obj_track_times(list, false);
  return list;
}
hid_t plain_dataset() {
  static const hid_t list = [] {
    const hid_t created = untimed(H5P_DATASET_CREATE);
    // A place in the file when created, not when written: in whatever
    // order fields become ready, a file is the same bytes.
    H5Pset_alloc_time(created, H5D_ALLOC_TIME_EARLY);
    return created;
  }();
  return list;
}
hid_t plain_group() {
  static const hid_t list = untimed(H5P_GROUP_CREATE);
  return list;
}
hid_t plain_file() {
  static const hid_t list = untimed(H5P_FILE_CREATE);
  return list;
}
hid_t fast_access() {
  // Compact groups and short headers of version 1.8, which every HDF5 and ParaView in use reads. Files are
  // written under names that nobody else opens, so the library's lock (which some network file systems
  // refuse) is not needed.
  static const hid_t list = [] {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_libver_bounds(access, H5F_LIBVER_V18, H5F_LIBVER_LATEST);
    H5Pset_file_locking(access, false, true);
    return access;
  }();
  return list;
}

// "file:dataset", "file:group/dataset"
std::string place_of(const Hdf5Group& group, const std::string& name) {
  return group.where() + (H5Iget_type(group.id()) == H5I_FILE ? ":" : "/") +
         name.substr(name.starts_with('/') ? 1 : 0);
}

hid_t read_access() {
  // Locked where the file system knows locks, so that a file under another program's pen is refused.
  static const hid_t list = [] {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_file_locking(access, true, true);
    return access;
  }();
  return list;
}

Hdf5Id creation_list(const Shape& shape, const Hdf5Storage& storage) {
  Hdf5Id list(untimed(H5P_DATASET_CREATE));
  check(storage.chunk.size() == shape.size(), "chunk and shape differ in rank");
  const std::vector<hsize_t> chunk(storage.chunk.begin(), storage.chunk.end());
  H5Pset_chunk(list.get(), static_cast<int>(chunk.size()), chunk.data());
  if (storage.shuffle) H5Pset_shuffle(list.get());
  if (storage.deflate > 0) H5Pset_deflate(list.get(), static_cast<unsigned>(storage.deflate));
  if (storage.fletcher32) H5Pset_fletcher32(list.get());
  return list;
}

Hdf5Id make_space(const Shape& shape, bool extendable) {
  if (shape.empty()) return Hdf5Id(H5Screate(H5S_SCALAR));
  const std::vector<hsize_t> size(shape.begin(), shape.end());
  auto most = size;
  if (extendable) most[0] = H5S_UNLIMITED;
  return Hdf5Id(H5Screate_simple(static_cast<int>(size.size()), size.data(), most.data()));
}

Hdf5Dataset create_dataset(const Hdf5Group& group, const std::string& name, hid_t type, const Shape& shape,
                           const Hdf5Storage& storage) {
  const auto space = make_space(shape, storage.extendable);
  Hdf5Id own_list;
  hid_t list = plain_dataset();
  if (!storage.chunk.empty()) {
    own_list = creation_list(shape, storage);
    list = own_list.get();
  }
  const auto where = place_of(group, name);
  return {
      Hdf5Id(writable(H5Dcreate2(group.id(), name.c_str(), type, space.get(), H5P_DEFAULT, list, H5P_DEFAULT),
                      "cannot create dataset", where)),
      where};
}

}  // namespace

InputError Hdf5Group::missing(const std::string& path, const char* kind) const {
  return InputError({.what = std::string("missing ") + kind + " '" + path + "'",
                     .where = where_,
                     .advice = names().empty() ? "" : base::name_advice(path, names())});
}

bool Hdf5Group::has(const std::string& path) const {
  quiet();
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    if (H5Lexists(id(), path.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return H5Oexists_by_name(id(), path.c_str(), H5P_DEFAULT) > 0;
  }
}

std::vector<std::string> Hdf5Group::names() const {
  std::vector<std::string> found;
  const auto keep = [](hid_t, const char* name, const H5L_info_t*, void* data) -> herr_t {
    static_cast<std::vector<std::string>*>(data)->emplace_back(name);
    return 0;
  };
  hsize_t index = 0;
  readable(H5Literate(id(), H5_INDEX_NAME, H5_ITER_NATIVE, &index, keep, &found), "cannot list group",
           where_);
  std::sort(found.begin(), found.end());
  return found;
}

Hdf5Group Hdf5Group::group(const std::string& path) const {
  if (!has(path)) throw missing(path, "group");
  Hdf5Id opened(
      readable(H5Oopen(id(), path.c_str(), H5P_DEFAULT), "cannot open group", place_of(*this, path)));
  if (H5Iget_type(opened.get()) != H5I_GROUP)
    throw InputError({.what = "not a group", .where = place_of(*this, path)});
  return {std::move(opened), place_of(*this, path)};
}

Hdf5Dataset Hdf5Group::dataset(const std::string& path) const {
  if (!has(path)) throw missing(path, "dataset");
  Hdf5Id opened(
      readable(H5Oopen(id(), path.c_str(), H5P_DEFAULT), "cannot open dataset", place_of(*this, path)));
  if (H5Iget_type(opened.get()) != H5I_DATASET)
    throw InputError({.what = "not a dataset", .where = place_of(*this, path)});
  return {std::move(opened), place_of(*this, path)};
}

Hdf5Group Hdf5Group::create_group(const std::string& name) const {
  const auto where = place_of(*this, name);
  return {Hdf5Id(writable(H5Gcreate2(id(), name.c_str(), H5P_DEFAULT, plain_group(), H5P_DEFAULT),
                          "cannot create group", where)),
          where};
}

template <class T>
Hdf5Dataset Hdf5Group::create(const std::string& name, const Shape& shape, const Hdf5Storage& storage) const {
  return create_dataset(*this, name, native_type<T>(), shape, storage);
}

template <class T>
Hdf5Dataset Hdf5Group::write(const std::string& name, std::span<const T> values, const Shape& shape,
                             const Hdf5Storage& storage) const {
  auto dataset = create<T>(name, shape.empty() ? Shape{values.size()} : shape, storage);
  dataset.write(values);
  return dataset;
}

Hdf5Dataset Hdf5Group::write_texts(const std::string& name, const std::vector<std::string>& values) const {
  const auto block = pack_texts(values);
  auto dataset = create_dataset(*this, name, block.type.get(), {values.size()}, {});
  if (values.empty()) return dataset;
  writable(H5Dwrite(dataset.id(), block.type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, block.bytes.data()),
           "cannot write dataset", dataset.where());
  return dataset;
}

void Hdf5Group::hard_link(const std::string& target, const std::string& name) const {
  writable(H5Lcreate_hard(id(), target.c_str(), id(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), "cannot link",
           place_of(*this, name));
}

void Hdf5Group::remove(const std::string& name) const {
  writable(H5Ldelete(id(), name.c_str(), H5P_DEFAULT), "cannot remove", place_of(*this, name));
}

Hdf5File Hdf5File::open(const std::filesystem::path& path, Access access) {
  quiet();
  const auto where = path.string();
  std::error_code fault;
  if (!std::filesystem::exists(path, fault)) throw InputError("no such file: " + where);
  if (!std::filesystem::is_regular_file(path, fault)) throw InputError("not a file: " + where);
  if (H5Fis_hdf5(path.c_str()) <= 0) throw InputError({.what = "not a readable HDF5 file", .where = where});
  const hid_t id = access == Access::edit ? H5Fopen(path.c_str(), H5F_ACC_RDWR, fast_access())
                                          : H5Fopen(path.c_str(), H5F_ACC_RDONLY, read_access());
  return Hdf5File(Hdf5Id(readable(id, "cannot open", where)), where);
}

Hdf5File Hdf5File::create(const std::filesystem::path& path) {
  quiet();
  return Hdf5File(Hdf5Id(writable(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, plain_file(), fast_access()),
                                  "cannot create", path.string())),
                  path.string());
}

void Hdf5File::flush() const {
  writable(H5Fflush(id(), H5F_SCOPE_GLOBAL), "cannot write (is the disk full?)", where_);
}

void Hdf5File::close() {
  if (id() < 0) return;
  flush();
  writable(H5Fclose(id_.release()), "cannot close", where_);
}

void write_kind(const Hdf5Object& object, const FileKind& kind) {
  object.set_text("kind", kind.name);
  object.set_integers("format", std::vector<std::int64_t>{kind.version.major, kind.version.minor});
  object.set_text("program", program_version());
}

FormatVersion check_kind(const Hdf5Object& object, const FileKind& expected) {
  const auto text = [&](const char* name) {
    return object.has_attribute(name) ? std::optional(object.text(name)) : std::nullopt;
  };
  std::optional<std::string> format;
  if (object.has_attribute("format")) {
    std::vector<std::string> parts;
    for (const double part : object.numbers("format")) parts.push_back(base::number(part));
    format = base::join(parts, ".");
  }
  return check_kind({text("kind"), format, text("program")}, expected, object.where());
}

#define ELROM_HDF5_TYPE(T)                                                                               \
  template Hdf5Dataset Hdf5Group::create<T>(const std::string&, const Shape&, const Hdf5Storage&) const; \
  template Hdf5Dataset Hdf5Group::write<T>(const std::string&, std::span<const T>, const Shape&,         \
                                           const Hdf5Storage&) const;
ELROM_HDF5_TYPE(float)
ELROM_HDF5_TYPE(double)
ELROM_HDF5_TYPE(std::int32_t)
ELROM_HDF5_TYPE(std::int64_t)
ELROM_HDF5_TYPE(std::uint8_t)
#undef ELROM_HDF5_TYPE

}  // namespace elrom::io
