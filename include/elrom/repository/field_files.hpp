#pragma once
// Files of fields by their digest: DIR/ab/abcdef....hdf. Each is written whole or not at all, and never
// changed.
//
// Thread rule: any thread; several processes may share a folder.

#include <filesystem>
#include <string>
#include <string_view>

namespace elrom::repository {

class FieldFiles {
 public:
  /// @param folder made when missing
  explicit FieldFiles(std::filesystem::path folder);

  /// On the disk when it returns. @return its digest. @throws SystemError (disk full)
  std::string put(std::string_view bytes) const;
  [[nodiscard]] bool has(const std::string& digest) const;
  /// Compared with its digest. @throws InputError when it is not there or damaged
  [[nodiscard]] std::string read(const std::string& digest) const;
  /// Where the file is, or would be. @throws UsageError for a text that is no digest
  [[nodiscard]] std::filesystem::path path(const std::string& digest) const;

 private:
  std::filesystem::path folder_;
};

[[nodiscard]] bool is_digest(std::string_view text);

}  // namespace elrom::repository
