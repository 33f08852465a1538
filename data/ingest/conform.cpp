#include "conform.hpp"

#include <algorithm>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"

namespace elrom::ingest {

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
