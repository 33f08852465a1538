#pragma once
// HDF5 files behind a small owning interface over the serial C library: files, groups, datasets, attributes.
// Every failure becomes an error that names "file:object"; the library's own printing is switched off.
//
// Numbers: float, double, int32, int64, uint8; the library converts between a file's type and the caller's.
// Text: written as fixed-length strings of exact length (ASCII where it is ASCII: ParaView 5.11 accepts
// nothing else in a VTKHDF header); read whether fixed or of variable length. Files hold no time stamps, so
// the same content gives the same bytes.
//
// Non-goals: parallel HDF5, compound types, references. Thread rule: one thread at a time per file.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/io/file_kind.hpp"

namespace elrom::io {

using Shape = std::vector<std::size_t>;
/// "20 x 42", "scalar"
[[nodiscard]] std::string text_of(const Shape& shape);

/// How a dataset is kept in the file. Default: contiguous, plain, cheapest to write.
struct Hdf5Storage {
  Shape chunk = {};  ///< empty: contiguous (the filters below need chunks)
  int deflate = 0;   ///< gzip level 0 to 9; 0: none
  bool shuffle = false;
  bool fletcher32 = false;  ///< checksum per chunk: a damaged chunk is an error on reading
  bool extendable = false;  ///< the first dimension may grow later

  /// One chunk of the whole shape (at most a few megabytes), shuffled, deflated, checksummed.
  [[nodiscard]] static Hdf5Storage packed(const Shape& shape, int level = 4);
};

/// A whole dataset as one chunk the way the file keeps it:
/// shuffled and deflated. For Hdf5Group::write_packed.
[[nodiscard]] std::vector<std::uint8_t> pack_chunk(std::span<const std::byte> values, std::size_t value_size);

/// Owner of one HDF5 identifier; closes it by its kind.
class Hdf5Id {
 public:
  Hdf5Id() = default;
  explicit Hdf5Id(std::int64_t id) : id_(id) {}
  Hdf5Id(Hdf5Id&& other) noexcept : id_(other.release()) {}
  Hdf5Id& operator=(Hdf5Id&& other) noexcept;
  ~Hdf5Id() { reset(); }
  [[nodiscard]] std::int64_t get() const { return id_; }
  void reset() noexcept;
  std::int64_t release() noexcept;

 private:
  std::int64_t id_ = -1;
};

/// What files, groups and datasets share: attributes and a place for messages.
class Hdf5Object {
 public:
  [[nodiscard]] std::int64_t id() const { return id_.get(); }
  [[nodiscard]] const std::string& where() const { return where_; }  ///< "file", "file:group/dataset"

  [[nodiscard]] bool has_attribute(const std::string& name) const;
  /// @throws InputError when it is missing or of another kind
  [[nodiscard]] std::string text(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> texts(const std::string& name) const;
  [[nodiscard]] double number(const std::string& name) const;
  [[nodiscard]] std::vector<double> numbers(const std::string& name) const;

  /// New attributes; one of that name is replaced. @throws SystemError when the file cannot be written
  void set_text(const std::string& name, std::string_view value) const;
  void set_texts(const std::string& name, const std::vector<std::string>& values) const;
  void set_number(const std::string& name, double value) const;
  void set_integer(const std::string& name, std::int64_t value) const;
  void set_integers(const std::string& name, std::span<const std::int64_t> values) const;
  void remove_attribute(const std::string& name) const;

 protected:
  Hdf5Object(Hdf5Id id, std::string where) : id_(std::move(id)), where_(std::move(where)) {}
  Hdf5Id id_;
  std::string where_;
};

class Hdf5Dataset : public Hdf5Object {
 public:
  Hdf5Dataset(Hdf5Id id, std::string where) : Hdf5Object(std::move(id), std::move(where)) {}

  [[nodiscard]] Shape shape() const;
  /// @throws InputError unless the shape is `expected`; 0 in it stands for any size
  void expect_shape(const Shape& expected) const;

  /// All values, row-major. T: float, double, int32_t, int64_t, uint8_t. @throws InputError (not numeric,
  /// checksum ...)
  template <class T>
  [[nodiscard]] std::vector<T> read() const;
  /// All values into `values`, whose size must be the dataset's.
  template <class T>
  void read_into(std::span<T> values) const;
  /// The box [offset, offset + count) into `values` (product of count), row-major.
  template <class T>
  void read_slab(const Shape& offset, const Shape& count, std::span<T> values) const;
  [[nodiscard]] std::vector<std::string> read_texts() const;

  template <class T>
  void write(std::span<const T> values) const;
  template <class T>
  void write_slab(const Shape& offset, const Shape& count, std::span<const T> values) const;
  /// New size of the first dimension of an extendable dataset.
  void extend(std::size_t first) const;
};

class Hdf5Group : public Hdf5Object {
 public:
  Hdf5Group(Hdf5Id id, std::string where) : Hdf5Object(std::move(id), std::move(where)) {}

  /// Paths may have several parts ("mesh/centre").
  [[nodiscard]] bool has(const std::string& path) const;
  /// Names of the members, sorted.
  [[nodiscard]] std::vector<std::string> names() const;
  /// @throws InputError when there is no such group / dataset, with the nearest name
  [[nodiscard]] Hdf5Group group(const std::string& path) const;
  [[nodiscard]] Hdf5Dataset dataset(const std::string& path) const;

  [[nodiscard]] Hdf5Group create_group(const std::string& name) const;
  template <class T>
  Hdf5Dataset create(const std::string& name, const Shape& shape, const Hdf5Storage& storage = {}) const;
  /// create() and write() in one; an empty `shape` stands for one dimension of values.size().
  template <class T>
  Hdf5Dataset write(const std::string& name, std::span<const T> values, const Shape& shape = {},
                    const Hdf5Storage& storage = {}) const;
  /// The same for values that pack_chunk() has packed: nothing is left to do but to copy the bytes.
  template <class T>
  Hdf5Dataset write_packed(const std::string& name, const Shape& shape,
                           std::span<const std::uint8_t> chunk) const;
  Hdf5Dataset write_texts(const std::string& name, const std::vector<std::string>& values) const;
  /// A second name for an existing object of the same file; `target` is an absolute path.
  void hard_link(const std::string& target, const std::string& name) const;
  /// A one-dimensional view of a dataset of the same file, without a copy (HDF5's virtual dataset): for
  /// readers that want cells in one row where the dataset has several dimensions.
  void flat_view(const Hdf5Dataset& target, const std::string& name) const;
  void remove(const std::string& name) const;

 protected:
  [[nodiscard]] InputError missing(const std::string& path, const char* kind) const;
};

class Hdf5File : public Hdf5Group {
 public:
  enum class Access { read, edit };
  /// @throws InputError when it cannot be read or is not HDF5
  [[nodiscard]] static Hdf5File open(const std::filesystem::path& path, Access access = Access::read);
  /// New file (anything there is replaced). Write it under a temporary name, see base/atomic_file.hpp.
  [[nodiscard]] static Hdf5File create(const std::filesystem::path& path);
  using Hdf5Group::create;

  /// Everything on its way to the file. @throws SystemError when it could not be written (disk full)
  void flush() const;
  /// flush() and close; no member may be used afterwards.
  void close();

 private:
  using Hdf5Group::Hdf5Group;
};

/// Malformed files find crashes in the HDF5 library itself. Runs `work`, all that will be read of the user's
/// file at `path`, in a child process first; memory and time are limited by the file's size. A file that
/// survived is not tried again while it stays as it is and `work_name` is the same.
/// @throws InputError when the child crashed or went beyond its limits, or what `work` threw there
/// Thread rule: as the library's, one thread at a time.
void survive(const std::filesystem::path& path, const std::string& work_name,
             const std::function<void()>& work);

/// Header of every file of ours: attributes `kind`, `format` = [major, minor], `program`.
void write_kind(const Hdf5Object& object, const FileKind& kind);
/// @return the file's version. @throws InputError as io::check_kind (file_kind.hpp)
FormatVersion check_kind(const Hdf5Object& object, const FileKind& expected);

}  // namespace elrom::io
