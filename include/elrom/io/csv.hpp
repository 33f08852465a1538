#pragma once
// Tables as text: one heading line, one record a line. Separated by commas, semicolons or tabs, whichever the
// headings have most of, or by what Excel's first line "sep=;" says; double quotes as in RFC 4180, any line
// ending, UTF-8 or, of files, UTF-16 with a byte order mark or Latin-1. Lines and rows without content, and
// lines that begin with '#', are skipped.
//
// Thread rule: plain values and pure functions.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/base/units.hpp"

namespace elrom::io {

struct CsvTable {
  std::string where;  ///< for messages: the file
  char separator = ',';
  std::vector<std::string> headings;           ///< trimmed, (n_columns)
  std::vector<std::vector<std::string>> rows;  ///< trimmed unless quoted, (n_rows, n_columns)
  std::vector<std::size_t> lines;              ///< line of each row in the file, from 1, (n_rows)

  /// "cases.csv:3, column 'load'"
  [[nodiscard]] std::string place(std::size_t row, std::size_t column) const;
  /// A cell's number and unit ("180 kg/s"); where commas do not separate, one is a decimal comma.
  /// @throws InputError for no finite number
  [[nodiscard]] base::Quantity quantity(std::size_t row, std::size_t column) const;
};

/// Largest text that the readers of tables and of case files take; anything larger is no such file.
inline constexpr std::size_t most_text_bytes = std::size_t{64} << 20;

/// @throws InputError for a row with a cell too many or too
/// few, an open quote, a binary file, no heading line
[[nodiscard]] CsvTable parse_csv(std::string_view text, std::string where);
[[nodiscard]] CsvTable read_csv(const std::filesystem::path& path);

/// The text of a small file in UTF-8, without a byte order mark. @throws InputError when it is larger than
/// most_text_bytes
[[nodiscard]] std::string read_small_text(const std::filesystem::path& path);

/// `cell` as the writer puts it: quoted when it must be.
[[nodiscard]] std::string csv_cell(std::string_view cell);

}  // namespace elrom::io
