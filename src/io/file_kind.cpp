#include "elrom/io/file_kind.hpp"

#include <charconv>

#include "elrom/base/error.hpp"

namespace elrom::io {
namespace {

/// A whole text of decimal digits.
std::optional<int> number_of(std::string_view text) {
  int value = 0;
  const auto [stop, fault] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (fault != std::errc{} || stop != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

std::optional<FormatVersion> version_of(std::string_view text) {
  const auto dot = text.find('.');
  if (dot == std::string_view::npos) return std::nullopt;
  const auto major = number_of(text.substr(0, dot)), minor = number_of(text.substr(dot + 1));
  if (!major || !minor) return std::nullopt;
  return FormatVersion{*major, *minor};
}

}  // namespace

FormatVersion check_kind(const FoundKind& found, const FileKind& expected, const std::string& where) {
  const std::string name(expected.name);
  if (found.kind != name) {
    throw InputError({.what = "wrong kind of file",
                      .where = where,
                      .found = found.kind.value_or("no kind"),
                      .expected = name});
  }
  const auto version = found.format ? version_of(*found.format) : std::nullopt;
  if (version && version->major == expected.version.major) return *version;
  throw InputError({.what = version ? "another format version" : "damaged format version",
                    .where = where,
                    .found = name + " " + found.format.value_or("without a version"),
                    .expected = name + " " + std::to_string(expected.version.major) + ".x",
                    .advice = "use the ELROM that wrote it" +
                              (found.program ? " (" + *found.program + ")" : "") + ", or " +
                              std::string(expected.remedy)});
}

}  // namespace elrom::io
