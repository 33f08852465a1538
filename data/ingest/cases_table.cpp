#include "elrom/ingest/cases_table.hpp"

#include <algorithm>
#include <cmath>

#include "conform.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"

namespace elrom::ingest {

namespace {

std::string shown(double si, const field::InputInfo& input) {
  return base::rounded(base::unit(input.display_unit).from_si(si), 6) + " " + input.display_unit;
}

void expect_agreement(const CfdCase& one, const field::CaseInputs& row, const CasesTable& table) {
  constexpr double tolerance = 1e-3;  // tables are written with a few digits
  const auto values = conform_inputs(one, table.schema);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::abs(values[i] - row.values[i]) <=
        tolerance * std::max(std::abs(values[i]), std::abs(row.values[i])))
      continue;
    const auto& input = table.schema[i];
    throw InputError({.what = "'" + input.name + "' of case '" + row.name + "' differs from its export",
                      .where = table.where,
                      .found = shown(row.values[i], input),
                      .expected = shown(values[i], input)});
  }
}

}  // namespace

CasesTable read_cases_table(const std::filesystem::path& path) {
  CasesTable table{.where = path.string(), .schema = field::read_schema(path)};
  table.cases = field::read_cases(path, table.schema);
  return table;
}

void complete_inputs(CfdCase& one, const CasesTable& table) {
  const auto& name = one.record.inputs.name;
  const auto row =
      std::find_if(table.cases.begin(), table.cases.end(), [&](const auto& c) { return c.name == name; });
  const bool carries = one.schema.size() > 0;
  if (row == table.cases.end()) {
    if (carries) return;
    std::vector<std::string> names;
    for (const auto& c : table.cases) names.push_back(c.name);
    throw InputError({.what = "no boundary conditions of case '" + name + "'",
                      .where = table.where,
                      .advice = base::name_advice(name, names)});
  }
  if (carries) {
    expect_agreement(one, *row, table);
    return;
  }
  one.schema = table.schema;
  one.record.inputs.values = row->values;
  if (!std::isnan(row->load)) one.record.inputs.load = row->load;
}

}  // namespace elrom::ingest
