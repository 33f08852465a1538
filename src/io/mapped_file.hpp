#pragma once
// A file mapped read-only into memory; internal to io.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace elrom::io {

/// The mapping lives as long as the object; a file that is
/// replaced by rename meanwhile keeps its old bytes here.
class MappedFile {
 public:
  /// @throws InputError when it cannot be opened, is no regular file, or is empty
  [[nodiscard]] static std::shared_ptr<const MappedFile> open(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  [[nodiscard]] std::span<const std::byte> bytes() const { return bytes_; }

 private:
  explicit MappedFile(std::span<const std::byte> bytes) : bytes_(bytes) {}
  std::span<const std::byte> bytes_;
};

}  // namespace elrom::io
