#include "case_list.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

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
  constexpr std::size_t most = 5;
  const std::size_t n_missing = missing.size();
  missing.resize(std::min(most, n_missing));
  throw UsageError({.what = std::to_string(n_missing) + " inputs are not given: " +
                            base::join(missing, ", ") + (n_missing > most ? ", ..." : ""),
                    .advice = "set them all, or start from a case by --cases FILE --case NAME"});
}

void check_name(const std::string& name) {
  if (!name.empty() && name.front() != '.' && name.find_first_of("/\\") == std::string::npos) return;
  throw InputError({.what = "case name cannot be a file's name",
                    .found = "'" + name + "'",
                    .expected = "a name without slashes that does not begin with a dot"});
}

}  // namespace

std::vector<field::CaseInputs> case_list(const Arguments& arguments, const field::InputSchema& schema) {
  std::vector<field::CaseInputs> cases;
  if (arguments.cases.empty()) {
    cases.push_back({arguments.name, not_given, std::vector<double>(schema.size(), not_given)});
  } else {
    cases = field::read_cases(arguments.cases, schema);
  }
  if (!arguments.case_patterns.empty()) keep_matching(cases, arguments.case_patterns);
  for (auto& item : cases) {
    for (const auto& setting : arguments.settings) field::apply_setting(item, setting, schema);
    check_complete(item, schema);
    check_name(item.name);
  }
  if (arguments.to_standard_output() && cases.size() != 1) {
    throw UsageError({.what = "--output - takes one case",
                      .found = std::to_string(cases.size()) + " cases",
                      .advice = "choose one by --case NAME"});
  }
  return cases;
}

}  // namespace elrom::fields
