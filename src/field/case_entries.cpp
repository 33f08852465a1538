#include "case_entries.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"

namespace elrom::field {

namespace detail {

namespace {

// base::unit() does not know where the symbol stands; we do.
const base::Unit& unit_at(std::string_view symbol, const std::string& where) {
  try {
    return base::unit(symbol);
  } catch (const InputError& error) {
    throw InputError({.what = error.what(), .where = where});
  }
}

std::string bracketed(const InputInfo& input) { return input.name + " [" + input.display_unit + "]"; }

/// For "primary_air (kg/s)": the brackets that were meant; else the nearest name.
std::string heading_advice(const std::string& name, const std::vector<std::string>& names) {
  const auto open = name.find('(');
  if (open != std::string::npos && name.ends_with(')')) {
    const auto before = base::trim(name.substr(0, open));
    const auto symbol = base::trim(name.substr(open + 1, name.size() - open - 2));
    if (std::ranges::find(names, before) != names.end()) return "write '" + before + " [" + symbol + "]'";
  }
  return base::name_advice(name, names);
}

}  // namespace

InputInfo input_info(std::string_view name, std::string_view symbol, const std::string& where) {
  const auto& unit = unit_at(symbol, where);
  return {.name = std::string(name), .unit = unit.si, .display_unit = unit.symbol};
}

double to_si(double value, std::string_view symbol, const InputInfo& input, const std::string& where) {
  const auto& unit = unit_at(symbol, where);
  if (unit.si == input.unit) return unit.to_si(value);
  throw InputError({.what = "wrong unit of '" + input.name + "'",
                    .where = where,
                    .found = "'" + std::string(symbol) + "'",
                    .expected = "one of " + base::join(base::units_of(input.unit), ", ")});
}

bool is_comment_column(std::string_view heading) {
  auto name = base::trim(heading);
  std::ranges::transform(name, name.begin(), [](unsigned char c) {
    return static_cast<char>(c >= 'A' && c <= 'Z' ? c + 32 : c);
  });
  if (name.empty()) return true;
  if (name.ends_with('s')) name.pop_back();
  return name == "comment" || name == "note" || name == "remark";
}

Columns match_columns(const std::vector<std::string>& headings, const InputSchema& schema,
                      const std::string& where) {
  constexpr auto nowhere = std::numeric_limits<std::size_t>::max();
  Columns columns{std::vector(schema.size(), nowhere), std::vector<std::string>(schema.size())};
  const auto names = schema.names();
  for (std::size_t column = 0; column < headings.size(); ++column) {
    const auto [name, symbol] = base::split_unit(headings[column]);
    if (name == "case" || name == "load" || is_comment_column(headings[column])) continue;
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) {
      throw InputError({.what = "unknown boundary condition '" + name + "'",
                        .where = where,
                        .advice = heading_advice(name, names)});
    }
    const auto i = static_cast<std::size_t>(found - names.begin());
    if (columns.position[i] != nowhere)
      throw InputError({.what = "boundary condition '" + name + "' appears twice", .where = where});
    columns.position[i] = column;
    columns.symbol[i] = symbol.empty() ? schema[i].display_unit : symbol;
    (void)to_si(0, columns.symbol[i], schema[i], where);
  }
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < schema.size(); ++i)
    if (columns.position[i] == nowhere) missing.push_back("'" + bracketed(schema[i]) + "'");
  if (missing.empty()) return columns;
  throw InputError({.what = missing.size() == 1
                                ? "missing boundary condition " + missing.front()
                                : std::to_string(missing.size()) +
                                      " boundary conditions are missing: " + base::join(missing, ", "),
                    .where = where});
}

double checked_load(double value, std::string_view symbol, const std::string& where) {
  constexpr double most = 2.0;
  const double load = to_si(value, symbol, {.name = "load", .unit = "1", .display_unit = "1"}, where);
  if (load >= 0 && load <= most) return load;
  throw InputError({.what = "load is no fraction of full load",
                    .where = where,
                    .found = base::number(value),
                    .expected = "0 to 2",
                    .advice = "write 'load [%]' for percent"});
}

void check_case_name(const std::string& name, const std::string& where) {
  constexpr std::size_t longest = 200;
  const bool bad_character = std::any_of(name.begin(), name.end(), [](char c) {
    return c == '/' || c == '\\' || static_cast<unsigned char>(c) < 32 || c == 127;
  });
  if (!name.empty() && name.size() <= longest && !bad_character && name.front() != '.') return;
  throw InputError({.what = "a case name that is no file name",
                    .where = where,
                    .found = name.empty() ? "an empty name"
                                          : (bad_character || name.size() > longest ? "" : "'" + name + "'"),
                    .expected = "1 to 200 characters, no slash, no leading dot"});
}

void check_unique_names(const std::vector<CaseInputs>& cases, const std::string& where) {
  std::set<std::string_view> seen;
  for (const auto& one : cases) {
    if (!seen.insert(one.name).second)
      throw InputError({.what = "case '" + one.name + "' appears twice", .where = where});
  }
}

}  // namespace detail

std::vector<CaseInputs> read_cases(const std::filesystem::path& path, const InputSchema& schema) {
  auto ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  auto cases = ending == ".json"   ? detail::read_cases_json(path, schema)
               : ending == ".toml" ? detail::read_cases_toml(path, schema)
                                   : detail::read_cases_csv(path, schema);
  if (cases.empty())
    throw InputError({.what = "no case", .where = path.string(), .expected = "at least one"});
  detail::check_unique_names(cases, path.string());
  return cases;
}

}  // namespace elrom::field
