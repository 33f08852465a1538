#include "summary.hpp"

#include <cmath>

#include "elrom/base/text.hpp"
#include "elrom/field/user_unit.hpp"
#include "elrom/io/csv.hpp"

namespace elrom::fields {
namespace {

std::string cell(double value) { return std::isfinite(value) ? base::rounded(value, 7) : std::string(); }

/// As predicted, and as the case was made from.
struct Pair {
  const CaseResult &own, &base;

  [[nodiscard]] std::string figure(std::size_t i) const {
    return own.figures.empty() ? "" : cell(own.figures[i]);
  }
  [[nodiscard]] std::string change(std::size_t i) const {
    const bool both = !own.figures.empty() && !base.figures.empty();
    return both ? cell(own.figures[i] - base.figures[i]) : "";
  }
};

std::vector<std::string> all_reasons(const CaseResult& result) {
  auto reasons = result.unusual_audit;
  reasons.insert(reasons.begin(), result.reason);
  return reasons;
}

}  // namespace

std::string summary_table(const Summary& summary) {
  const auto& [schema, list, names, results] = summary;
  const bool with_bases = !list.swept.empty();
  std::vector<std::string> headings{"case", "base", "verdict", "distance", "reason"};
  std::vector<const base::Unit*> units;
  for (const auto i : list.swept) {
    units.push_back(&user_unit(schema[i]));
    headings.push_back(schema[i].name + " [" + units.back()->symbol + "]");
  }
  headings.insert(headings.end(), names.begin(), names.end());
  for (const auto& name : names)
    if (with_bases) headings.push_back("change of " + name);
  std::string text = base::join(headings, ",") + "\n";
  for (std::size_t k = 0; k < list.cases.size(); ++k) {
    const auto i_base = list.origins[k].base;
    const Pair pair{results[k], results[i_base]};
    std::vector<std::string> row{io::csv_cell(list.cases[k].name), io::csv_cell(list.cases[i_base].name),
                                 std::string(model::name_of(pair.own.verdict)), cell(pair.own.distance),
                                 io::csv_cell(base::join(all_reasons(pair.own), "; "))};
    for (std::size_t s = 0; s < list.swept.size(); ++s)
      row.push_back(cell(units[s]->from_si(list.cases[k].values[list.swept[s]])));
    for (std::size_t i = 0; i < names.size(); ++i) row.push_back(pair.figure(i));
    for (std::size_t i = 0; with_bases && i < names.size(); ++i) row.push_back(pair.change(i));
    text += base::join(row, ",") + "\n";
  }
  return text;
}

}  // namespace elrom::fields
