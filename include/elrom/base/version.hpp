#pragma once
// What wrote a file: kept in every file's provenance.

#include <string>
#include <string_view>

namespace elrom {

/// "1.0.0"
[[nodiscard]] std::string_view version();
/// Abbreviated commit of the source, "unknown" outside a checkout; "+" at the end: with local changes.
[[nodiscard]] std::string_view git_hash();
/// "ELROM 1.0.0 (abc1234)"
[[nodiscard]] std::string program_version();

/// Version pair of a file kind. Readers accept their own major and any minor.
struct FormatVersion {
  int major = 1;
  int minor = 0;
  [[nodiscard]] std::string text() const { return std::to_string(major) + "." + std::to_string(minor); }
};

}  // namespace elrom
