#include "conform.hpp"

#include <algorithm>
#include <cmath>

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

std::vector<double> conform_inputs(const CfdCase& one, const field::InputSchema& schema) {
  const auto names = one.schema.names(), known = schema.names();
  if (names.empty() && !known.empty()) {
    throw InputError({.what = "no boundary conditions",
                      .where = one.record.source,
                      .advice = "give them in a table by --cases"});
  }
  for (const auto& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw InputError({.what = "unknown boundary condition '" + name + "'",
                      .where = one.record.source,
                      .advice = base::name_advice(name, known)});
  }
  std::vector<double> values;
  for (const auto& input : schema.inputs()) {
    const auto found = std::find(names.begin(), names.end(), input.name);
    if (found == names.end())
      throw InputError(
          {.what = "missing boundary condition '" + input.name + "'", .where = one.record.source});
    const auto i = static_cast<std::size_t>(found - names.begin());
    if (one.schema[i].unit != input.unit) {
      throw InputError({.what = "wrong unit of '" + input.name + "'",
                        .where = one.record.source,
                        .found = "'" + one.schema[i].display_unit + "'",
                        .expected = "one of " + base::join(base::units_of(input.unit), ", ")});
    }
    values.push_back(one.record.inputs.values[i]);
  }
  return values;
}

MatrixF conform_fields(const CfdCase& one, const std::vector<field::FieldInfo>& fields) {
  std::vector<std::string> names;
  for (const auto& f : one.fields) names.push_back(f.name);
  MatrixF values(static_cast<Eigen::Index>(fields.size()), one.values.cols());
  for (std::size_t f = 0; f < fields.size(); ++f) {
    const auto found = std::find(names.begin(), names.end(), fields[f].name);
    if (found == names.end()) {
      throw InputError({.what = "missing field '" + fields[f].name + "'",
                        .where = one.record.source,
                        .advice = base::name_advice(fields[f].name, names)});
    }
    const auto row = found - names.begin();
    if (one.fields[static_cast<std::size_t>(row)].unit != fields[f].unit) {
      throw InputError({.what = "wrong unit of field '" + fields[f].name + "'",
                        .where = one.record.source,
                        .found = "'" + one.fields[static_cast<std::size_t>(row)].unit + "'",
                        .expected = "'" + fields[f].unit + "'"});
    }
    values.row(static_cast<Eigen::Index>(f)) = one.values.row(row);
  }
  return values;
}

}  // namespace elrom::ingest
