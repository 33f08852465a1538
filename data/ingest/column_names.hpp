#pragma once
// The names that other programs give to the columns of a solution
// table. The table is documented in data/FORMATS.md.

#include <string>
#include <string_view>
#include <vector>

namespace elrom::ingest {

/// What a column of a solution table holds.
enum class ColumnKind { ignored, x, y, z, volume, field };

struct ColumnMeaning {
  ColumnKind kind = ColumnKind::ignored;
  std::string field = {};  ///< our name, for ColumnKind::field
  std::string si = "1";    ///< SI unit of the column's dimension
};

/// Meaning of a heading without its unit ("solids-x-velocity", "x-coordinate", "pressure"). Case, '-', '_'
/// and blanks do not count. Unknown headings are `ignored`.
[[nodiscard]] ColumnMeaning column_meaning(std::string_view heading);

/// Every spelling that stands for one of our fields, for messages and documentation.
[[nodiscard]] std::vector<std::string> known_headings(std::string_view field);

}  // namespace elrom::ingest
