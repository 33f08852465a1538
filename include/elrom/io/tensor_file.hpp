#pragma once
// Tensor files in the safetensors layout: u64 little-endian header length, JSON header, raw little-endian
// tensors. The reader maps the file and copies nothing. Every tensor's SHA-256 is kept in `__metadata__`
// under "sha256:tensor/<name>", and that of the header's own text (without these 64 digits) under
// "sha256:header", so a flipped byte is always found.
//
// Non-goals: compression, editing in place, other byte orders.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/io/file_kind.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::io {

enum class DType { f16, f32, f64, i32, i64, u8 };
[[nodiscard]] std::size_t size_of(DType type);
[[nodiscard]] std::string_view name_of(DType type);  ///< "F16", "F32", ... as in the file

/// An immutable n-d array, row-major; shares ownership of its bytes (a mapped file or a vector). Cheap to
/// copy. Thread rule: const use from any thread.
class Tensor {
 public:
  Tensor() = default;
  Tensor(DType type, std::vector<std::size_t> shape, std::shared_ptr<const void> owner,
         const std::byte* data);

  [[nodiscard]] static Tensor copy(const MatrixF& values);
  [[nodiscard]] static Tensor copy(const MatrixD& values);
  [[nodiscard]] static Tensor copy(std::span<const float> values, std::vector<std::size_t> shape);
  [[nodiscard]] static Tensor copy(std::span<const double> values, std::vector<std::size_t> shape);
  [[nodiscard]] static Tensor copy(std::span<const std::int32_t> values, std::vector<std::size_t> shape);
  [[nodiscard]] static Tensor copy(std::span<const std::uint8_t> values, std::vector<std::size_t> shape);

  [[nodiscard]] DType type() const { return type_; }
  [[nodiscard]] const std::vector<std::size_t>& shape() const { return shape_; }
  [[nodiscard]] std::size_t size() const;  ///< number of values
  [[nodiscard]] bool empty() const { return data_ == nullptr; }
  [[nodiscard]] std::span<const std::byte> bytes() const;
  /// Values of exactly that type. @throws InputError for another type
  [[nodiscard]] std::span<const std::uint16_t> f16() const;  ///< bit patterns of IEEE half precision
  [[nodiscard]] std::span<const float> f32() const;
  [[nodiscard]] std::span<const double> f64() const;
  [[nodiscard]] std::span<const std::int32_t> i32() const;
  [[nodiscard]] std::span<const std::uint8_t> u8() const;
  /// Rank 2 (or rank 1 as one row) as a matrix view. @throws InputError for another rank or type
  [[nodiscard]] ConstMapF matrix() const;
  [[nodiscard]] Eigen::Map<const MatrixD> matrix64() const;

 private:
  DType type_ = DType::f32;
  std::vector<std::size_t> shape_;
  std::shared_ptr<const void> owner_;
  const std::byte* data_ = nullptr;
};

/// Stands in a wanted shape for any size. Not 0: an empty tensor must not pass where 3 are wanted because
/// another one, which gave the number, was empty too.
inline constexpr std::size_t any_size = static_cast<std::size_t>(-1);

/// Whether a tensor's bytes are compared with its digest each time it is fetched by name.
enum class Verify { never, on_use };

/// A set of named tensors and named texts, in memory or in a mapped file.
class TensorFile {
 public:
  TensorFile() = default;
  /// Maps `path`; checks the whole header (no duplicate names, overlaps, holes, overflow;
  /// header <= 4 MiB and 16,384 tensors) and its digest, but reads no tensor. @throws
  /// InputError naming the file, what was found and what was expected
  [[nodiscard]] static TensorFile open(const std::filesystem::path& path, Verify verify = Verify::never);

  [[nodiscard]] bool has(std::string_view name) const { return tensors_.contains(std::string(name)); }
  [[nodiscard]] const std::map<std::string, Tensor>& tensors() const { return tensors_; }
  /// @throws InputError naming file and tensor when it is not there (with the nearest name), or, of a file
  /// opened with Verify::on_use, when its bytes do not match their digest; tensors() compares nothing
  [[nodiscard]] const Tensor& tensor(std::string_view name) const;
  /// Several at once: their digests take half the time.
  [[nodiscard]] std::vector<Tensor> tensors(std::span<const std::string> names) const;
  /// One, with its shape checked; `any_size` in `shape` stands for any.
  [[nodiscard]] const Tensor& tensor(std::string_view name, std::span<const std::size_t> shape) const;
  [[nodiscard]] const std::map<std::string, std::string>& texts() const { return texts_; }
  [[nodiscard]] bool has_text(std::string_view key) const { return texts_.contains(std::string(key)); }
  [[nodiscard]] const std::string& text(std::string_view key) const;

  void set(std::string name, Tensor tensor);
  void set_text(std::string key, std::string text);

  /// Compares the digest of one tensor, or of all, with what was read from the file; tensors that were set()
  /// here have none and pass. @throws InputError naming file and tensor
  void verify(std::string_view name) const;
  void verify_all(int n_threads = 1) const;

  /// Atomically. Tensors are laid out by falling alignment (64 bytes where the size allows, never below their
  /// element's) and then by name, without padding. The same content gives the same bytes.
  /// @throws UsageError for more tensors than open() takes, SystemError when the disk does not take it
  void write(const std::filesystem::path& path) const;

  [[nodiscard]] const std::string& where() const { return where_; }  ///< path, for messages
  /// SHA-256 of the header (which holds every tensor's digest): the file's identity; empty for a set that was
  /// never written or read.
  [[nodiscard]] const std::string& digest() const { return digest_; }

 private:
  [[nodiscard]] const Tensor& find(std::string_view name) const;
  /// @throws InputError when a tensor's bytes do not match their digest
  void compare(std::span<const std::string> names, std::span<const Tensor> tensors) const;

  Verify verify_ = Verify::never;
  std::map<std::string, Tensor> tensors_;
  std::map<std::string, std::string> texts_;
  std::map<std::string, std::string> digests_;  //!< as read, by tensor
  std::string where_ = "memory";
  mutable std::string digest_;
};

/// Texts `kind`, `format` and `program`; the file's version; as io::check_kind (file_kind.hpp).
void write_kind(TensorFile& file, const FileKind& kind);
FormatVersion check_kind(const TensorFile& file, const FileKind& expected);

}  // namespace elrom::io
