#include "case_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/possible_inputs.hpp"
#include "elrom/field/user_unit.hpp"

namespace elrom::fields {
namespace {

constexpr double not_given = std::numeric_limits<double>::quiet_NaN();

void keep_matching(std::vector<field::CaseInputs>& cases, const std::vector<std::string>& patterns) {
  std::vector<std::string> names;
  for (const auto& item : cases) names.push_back(item.name);
  for (const auto& pattern : patterns) {
    const auto fits = [&](const std::string& name) { return base::matches(name, pattern); };
    if (std::any_of(names.begin(), names.end(), fits)) continue;
    throw UsageError(
        {.what = "no case '" + pattern + "' in the table", .advice = base::name_advice(pattern, names)});
  }
  std::erase_if(cases, [&](const field::CaseInputs& item) {
    return std::none_of(patterns.begin(), patterns.end(),
                        [&](const std::string& pattern) { return base::matches(item.name, pattern); });
  });
}

void check_complete(const field::CaseInputs& inputs, const field::InputSchema& schema) {
  std::vector<std::string> missing;
  for (std::size_t i = 0; i < schema.size(); ++i) {
    if (std::isnan(inputs.values[i])) missing.push_back(schema[i].name);
  }
  if (missing.empty()) return;
  throw UsageError({.what = std::to_string(missing.size()) +
                            (missing.size() == 1 ? " input is" : " inputs are") +
                            " not given: " + base::join(missing, ", "),
                    .advice = "set them all, or start from a case by --cases FILE --case NAME"});
}

/// A name that the files of the case can have.
void check_name(const std::string& name) {
  constexpr std::size_t longest = 200;
  const bool plain = !name.empty() && name.front() != '.' && name.find_first_of("/\\") == std::string::npos;
  if (plain && name.size() <= longest) return;
  throw InputError(
      {.what = "case name cannot be a file's name",
       .found = "'" + name.substr(0, longest) + "'",
       .expected = "at most " + std::to_string(longest) + " characters, no slashes, no dot at the beginning",
       .advice = "--name gives another"});
}

/// "kg/s" as a file's name can have it: "kg_s".
std::string in_a_name(std::string symbol) {
  std::ranges::replace_if(
      symbol, [](char c) { return std::string_view("/\\ ()*^").find(c) != std::string_view::npos; }, '_');
  return symbol;
}

/// "+primary_air=180", with a unit where that is not the one that numbers without a unit are in.
std::string change_text(const field::InputInfo& info, double si, const base::Unit& unit) {
  constexpr int digits = 6;
  const auto symbol = unit.symbol == user_unit(info).symbol ? "" : in_a_name(unit.symbol);
  return "+" + info.name + "=" + base::rounded(unit.from_si(si), digits) + symbol;
}

/// The unit of "name=value unit"; without one the user's.
const base::Unit& unit_of_setting(std::string_view setting, const field::InputInfo& info) {
  const auto given = base::split_quantity(setting.substr(setting.find('=') + 1));
  return given && !given->symbol.empty() ? base::unit(given->symbol) : user_unit(info);
}

/// The input that a setting or a sweep names: its text up to '='.
std::string_view name_in(std::string_view setting) { return setting.substr(0, setting.find('=')); }

void apply_settings(std::vector<field::CaseInputs>& cases, const Arguments& arguments,
                    const field::InputSchema& schema) {
  if (arguments.settings.empty()) return;
  for (auto& item : cases) {
    std::string suffix;
    std::vector<CaseList::Moved> changed;
    for (const auto& setting : arguments.settings) {
      field::apply_setting(item, setting, schema);
      const auto i = schema.index_of(base::trim(name_in(setting)));
      auto known = std::ranges::find(changed, i, &CaseList::Moved::input);
      if (known == changed.end()) known = changed.insert(known, {i, nullptr});
      known->unit = &unit_of_setting(setting, schema[i]);
    }
    for (const auto& [i, unit] : changed) suffix += change_text(schema[i], item.values[i], *unit);
    const bool from_table = !arguments.cases.empty();
    if (!arguments.name.empty()) {
      item.name = cases.size() > 1 ? item.name + "+" + arguments.name : arguments.name;
    } else if (from_table) {
      item.name += suffix;
    }
  }
}

struct Sweep {
  CaseList::Moved swept;
  std::vector<double> values;  //!< SI
};

[[noreturn]] void refuse_sweep(const std::string& text, const std::string& what = "--sweep cannot be read",
                               const std::string& advice = "") {
  throw UsageError({.what = what,
                    .found = "'" + text + "'",
                    .expected = "name=start:stop:step, such as 'primary_air=150:200:5 kg/s'",
                    .advice = advice});
}

/// As given, in the sweep's unit.
struct Steps {
  double start, step, n;
  std::string symbol;
};

Steps steps_of(const std::string& text) {
  constexpr double most_values = 10'000;
  const auto equals = text.find('=');
  const auto sides = base::split(equals == std::string::npos ? "" : text.substr(equals + 1), ':');
  if (sides.size() != 3) refuse_sweep(text);
  const auto start = base::to_double(base::trim(sides[0])), stop = base::to_double(base::trim(sides[1]));
  const auto step = base::split_quantity(sides[2]);
  if (!start || !stop || !step || !std::isfinite(*start) || !std::isfinite(*stop)) refuse_sweep(text);
  if (step->value == 0) refuse_sweep(text, "--sweep has a step of 0");
  const double n_steps = std::floor((*stop - *start) / step->value + 1e-9);
  if (n_steps < 0)
    refuse_sweep(text, "--sweep runs away from its end",
                 "a step of " + base::number(-step->value) + " leads from " + base::number(*start) + " to " +
                     base::number(*stop));
  if (n_steps >= most_values)
    throw UsageError(
        {.what = "--sweep has too many values", .found = "'" + text + "'", .expected = "at most 10000"});
  return {*start, step->value, n_steps, step->symbol};
}

Sweep parse_sweep(const std::string& text, const field::InputSchema& schema) {
  const auto steps = steps_of(text);
  const auto i = schema.index_of(base::trim(name_in(text)));
  field::CaseInputs one{
      .name = "", .load = not_given, .values = std::vector<double>(schema.size(), not_given)};
  Sweep sweep{{i, nullptr}, {}};
  for (double k = 0; k <= steps.n; ++k) {
    const auto value = base::number(steps.start + k * steps.step) + " " + steps.symbol;
    field::apply_setting(one, std::string(name_in(text)) + "=" + value, schema);
    sweep.values.push_back(one.values[i]);
  }
  sweep.swept.unit = steps.symbol.empty() ? &user_unit(schema[i]) : &base::unit(steps.symbol);
  return sweep;
}

void expect_swept_once(const std::vector<Sweep>& sweeps, const Arguments& arguments,
                       const field::InputSchema& schema) {
  std::set<std::size_t> seen;
  for (const auto& sweep : sweeps)
    if (!seen.insert(sweep.swept.input).second)
      throw UsageError("'" + schema[sweep.swept.input].name + "' is swept twice");
  if (arguments.cases.empty()) return;  // where --set gives the base its values
  for (const auto& setting : arguments.settings)
    if (const auto i = schema.index_of(base::trim(name_in(setting))); seen.contains(i))
      throw UsageError({.what = "'" + schema[i].name + "' is in --set and in --sweep",
                        .expected = "one of them",
                        .advice = "the base has the table's value, and the sweep moves it"});
}

using Changes = std::vector<std::pair<const CaseList::Moved*, double>>;

/// Every combination of the sweeps' values, or one input at a time.
std::vector<Changes> changes_of(const std::vector<Sweep>& sweeps, bool grid) {
  std::vector<Changes> changes;
  if (sweeps.empty()) return changes;
  if (!grid) {
    for (const auto& sweep : sweeps)
      for (const double value : sweep.values) changes.push_back({{&sweep.swept, value}});
    return changes;
  }
  constexpr std::size_t most = 1'000'000;
  changes.emplace_back();
  for (const auto& sweep : sweeps) {
    if (changes.size() * sweep.values.size() > most)
      throw UsageError("--grid has too many combinations; at most a million");
    std::vector<Changes> longer;
    for (const auto& so_far : changes) {
      for (const double value : sweep.values) {
        longer.push_back(so_far);
        longer.back().emplace_back(&sweep.swept, value);
      }
    }
    changes = std::move(longer);
  }
  return changes;
}

/// Each base, and after it all that the sweeps make of it.
CaseList sweep_all(std::vector<field::CaseInputs> bases, const Arguments& arguments,
                   const field::InputSchema& schema) {
  CaseList list;
  std::vector<Sweep> sweeps;
  for (const auto& text : arguments.sweeps) {
    sweeps.push_back(parse_sweep(text, schema));
    list.swept.push_back(sweeps.back().swept);
  }
  expect_swept_once(sweeps, arguments, schema);
  const auto changes = changes_of(sweeps, arguments.grid);
  for (auto& base : bases) {
    const auto i_base = list.cases.size();
    list.cases.push_back(std::move(base));
    list.origins.push_back({i_base, {}});
    for (const auto& change : changes) {
      auto variant = list.cases[i_base];
      CaseList::Origin origin{i_base, {}};
      for (const auto& [swept, value] : change) {
        variant.values[swept->input] = value;
        variant.name += change_text(schema[swept->input], value, *swept->unit);
        origin.changed.push_back(swept->input);
      }
      list.cases.push_back(std::move(variant));
      list.origins.push_back(std::move(origin));
    }
  }
  return list;
}

std::vector<field::CaseInputs> chosen_cases(const Arguments& arguments, const field::InputSchema& schema) {
  if (arguments.cases.empty())
    return {{arguments.name.empty() ? "case" : arguments.name, not_given,
             std::vector<double>(schema.size(), not_given)}};
  auto cases = field::read_cases(arguments.cases == "-" ? "/dev/stdin" : arguments.cases, schema);
  if (!arguments.case_patterns.empty()) keep_matching(cases, arguments.case_patterns);
  return cases;
}

}  // namespace

CaseList case_list(const Arguments& arguments, const field::InputSchema& schema) {
  auto bases = chosen_cases(arguments, schema);
  apply_settings(bases, arguments, schema);
  for (const auto& item : bases) check_complete(item, schema);
  auto list = sweep_all(std::move(bases), arguments, schema);
  std::set<std::string_view> names;
  for (const auto& item : list.cases) {
    check_name(item.name);
    check_possible(item, schema);
    if (!names.insert(item.name).second)
      throw UsageError({.what = "two cases of one name",
                        .found = "'" + item.name + "'",
                        .advice = "a coarser --sweep, or another --name"});
  }
  const bool only_csv = arguments.formats == std::vector{Format::csv};
  if (arguments.to_standard_output() && list.cases.size() != 1 && !only_csv) {
    throw UsageError(
        {.what = std::string("--output - takes one case as ") + info_of(arguments.formats[0]).name,
         .found = std::to_string(list.cases.size()) + " cases",
         .advice = "choose one by --case NAME, or --format csv"});
  }
  return list;
}

}  // namespace elrom::fields
