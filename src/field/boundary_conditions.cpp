#include "elrom/field/boundary_conditions.hpp"

#include <algorithm>

#include "case_entries.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/io/csv.hpp"

namespace elrom::field {
namespace {

/// The first of a long list.
std::string listed(std::vector<std::string> names) {
  constexpr std::size_t most = 10;
  const bool more = names.size() > most;
  if (more) names.resize(most);
  return base::join(names, ", ") + (more ? ", ..." : "");
}

}  // namespace

std::vector<std::string> InputSchema::names() const {
  std::vector<std::string> names;
  for (const auto& input : inputs_) names.push_back(input.name);
  return names;
}

std::size_t InputSchema::index_of(std::string_view name) const {
  const auto found =
      std::find_if(inputs_.begin(), inputs_.end(), [&](const InputInfo& i) { return i.name == name; });
  if (found != inputs_.end()) return static_cast<std::size_t>(found - inputs_.begin());
  throw InputError(
      {.what = "unknown boundary condition '" + std::string(name) + "'",
       .advice = name == "load"
                     ? "a load is a case's label, and no model goes by it; known are: " + listed(names())
                     : base::name_advice(name, names())});
}

InputSchema read_schema(const std::filesystem::path& cases_csv) {
  const auto table = io::read_csv(cases_csv);
  std::vector<InputInfo> inputs;
  for (const auto& heading : table.headings) {
    const auto [name, symbol] = base::split_unit(heading);
    if (name == "case" || name == "load" || detail::is_comment_column(heading)) continue;
    if (name.empty()) throw InputError({.what = "a column without a name", .where = table.where});
    if (std::any_of(inputs.begin(), inputs.end(), [&n = name](const InputInfo& i) { return i.name == n; })) {
      throw InputError({.what = "boundary condition '" + name + "' appears twice", .where = table.where});
    }
    inputs.push_back(detail::input_info(name, symbol, table.where));
  }
  return InputSchema(std::move(inputs));
}

void apply_setting(CaseInputs& inputs, std::string_view setting, const InputSchema& schema) {
  const auto equals = setting.find('=');
  const std::string place = "setting '" + std::string(setting) + "'";
  if (equals == std::string_view::npos)
    throw UsageError({.what = "no '='", .where = place, .expected = "name=value or name='value unit'"});
  const auto name = base::trim(setting.substr(0, equals));
  const auto right = base::trim(setting.substr(equals + 1));
  const auto given = base::split_quantity(right);
  if (!given) throw UsageError({.what = "no finite number", .where = place, .found = "'" + right + "'"});
  check(inputs.values.size() == schema.size(), "inputs and schema differ in size");
  const auto i = schema.index_of(name);
  inputs.values[i] = detail::to_si(
      given->value, given->symbol.empty() ? schema[i].display_unit : given->symbol, schema[i], place);
}

}  // namespace elrom::field
