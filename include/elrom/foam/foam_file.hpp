#pragma once
// OpenFOAM's ascii dictionaries, plain or gzip: just enough of the syntax for meshes, fields and clouds.
//
// Non-goals: binary files, #include and #calc directives, regular-expression keywords.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::foam {

/// A file read whole, with a reading position. Every throw is
/// an InputError naming file, line, found and expected.
class FoamFile {
 public:
  /// Opens `path` or `path`.gz. @throws InputError when neither is
  /// there, or its FoamFile header says `format binary`
  explicit FoamFile(const std::filesystem::path& path);
  [[nodiscard]] static bool exists(const std::filesystem::path& path);

  /// Moves behind the top-level keyword, searching from the
  /// file's beginning. @return false when it is not there
  [[nodiscard]] bool seek(std::string_view keyword);
  /// The same for an entry that must be there.
  void seek_required(std::string_view keyword);

  /// `class` of the header; empty without one.
  [[nodiscard]] const std::string& class_name() const { return class_; }
  /// All behind the header, with another value of a top-level entry (without its semicolon). Where the rest
  /// repeats the entry by `$keyword`, it gets the value that was there, which patches can hold.
  [[nodiscard]] std::string body_with(std::string_view keyword, std::string_view value);

  [[nodiscard]] bool at_end();
  /// Next word or one of ( ) { } [ ] ; -- comments and blanks are skipped.
  std::string_view token();
  /// Next token without taking it.
  std::string_view peek();
  void expect(std::string_view wanted);
  double number();
  std::size_t label();

  /// `N(...)` or `N{value}`; @param n_expected 0: any number
  std::vector<double> scalars(std::size_t n_expected = 0);
  std::vector<std::size_t> labels(std::size_t n_expected = 0);
  /// (n, 3)
  MatrixD vectors(std::size_t n_expected = 0);
  /// The value of "keyword value;", also with the older "keyword name [dimensions] value;".
  double dictionary_number(std::string_view keyword);
  std::string dictionary_word(std::string_view keyword);

  /// Number of a list's entries, refused when the file could not hold that many (@param least_bytes each).
  std::size_t list_size(std::size_t n_expected, std::size_t least_bytes);
  /// Start of a file's only list, behind the header.
  void to_body();
  [[noreturn]] void fail(std::string_view found, std::string_view expected) const;

 private:
  void skip_blanks();
  void skip_entry();
  void check_header();

  std::string path_, text_, class_;
  std::size_t at_ = 0, body_ = 0;
};

/// internalField of a volume field, (n_cells, n_components). @param n_components 1 or 3 @throws InputError
[[nodiscard]] MatrixD read_internal_field(const std::filesystem::path& path, std::size_t n_cells,
                                          int n_components);

}  // namespace elrom::foam
