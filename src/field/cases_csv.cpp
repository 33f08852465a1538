#include <cmath>
#include <limits>

#include "case_entries.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/io/csv.hpp"

namespace elrom::field::detail {

namespace {

constexpr auto nowhere = std::numeric_limits<std::size_t>::max();

std::size_t column_of(const io::CsvTable& table, std::string_view name) {
  std::size_t found = nowhere;
  for (std::size_t i = 0; i < table.headings.size(); ++i) {
    if (base::split_unit(table.headings[i]).name != name) continue;
    if (found != nowhere)
      throw InputError({.what = "column '" + std::string(name) + "' appears twice", .where = table.where});
    found = i;
  }
  return found;
}

}  // namespace

std::vector<CaseInputs> read_cases_csv(const std::filesystem::path& path, const InputSchema& schema) {
  const auto table = io::read_csv(path);
  const auto name_column = column_of(table, "case"), load_column = column_of(table, "load");
  if (name_column == nowhere) throw InputError({.what = "missing column 'case'", .where = table.where});
  const auto columns = match_columns(table.headings, schema, table.where);
  std::vector<CaseInputs> cases;
  for (std::size_t row = 0; row < table.rows.size(); ++row) {
    CaseInputs one{.name = table.rows[row][name_column], .load = std::nan("")};
    check_case_name(one.name, table.place(row, name_column));
    if (load_column != nowhere && !table.rows[row][load_column].empty()) {
      const auto given = table.quantity(row, load_column);
      const auto symbol =
          given.symbol.empty() ? base::split_unit(table.headings[load_column]).symbol : given.symbol;
      one.load = checked_load(given.value, symbol, table.place(row, load_column));
    }
    for (std::size_t i = 0; i < schema.size(); ++i) {
      const auto column = columns.position[i];
      const auto given = table.quantity(row, column);
      one.values.push_back(to_si(given.value, given.symbol.empty() ? columns.symbol[i] : given.symbol,
                                 schema[i], table.place(row, column)));
    }
    cases.push_back(std::move(one));
  }
  return cases;
}

}  // namespace elrom::field::detail
