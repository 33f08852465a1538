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

/// The sweep, and nothing else, made the audit unusual.
bool is_held_alone(const Summary& summary, std::size_t k) {
  const auto& base = summary.results[summary.list.origins[k].base];
  return !summary.results[k].unusual_audit.empty() && base.unusual_audit.empty();
}

std::vector<std::string> all_reasons(const Summary& summary, std::size_t k) {
  const auto& result = summary.results[k];
  auto reasons = result.unusual_audit;
  reasons.insert(reasons.begin(), result.reason);
  if (is_held_alone(summary, k)) reasons.emplace_back("only since the other inputs were held");
  return reasons;
}

/// "24 other inputs at the values of load_064"; empty for a base.
std::string held_text(const Summary& summary, std::size_t k) {
  const auto& origin = summary.list.origins[k];
  if (origin.base == k) return "";
  return std::to_string(summary.schema.size() - origin.changed.size()) + " other inputs at the values of " +
         summary.list.cases[origin.base].name;
}

}  // namespace

std::size_t n_held_alone(const Summary& summary) {
  std::size_t n = 0;
  for (std::size_t k = 0; k < summary.list.cases.size(); ++k) n += is_held_alone(summary, k) ? 1 : 0;
  return n;
}

std::string summary_table(const Summary& summary) {
  const auto& [schema, list, names, results] = summary;
  const bool with_bases = !list.swept.empty();
  std::vector<std::string> headings{"case", "base", "verdict", "distance", "reason"};
  if (with_bases) headings.emplace_back("held");
  for (const auto& swept : list.swept)
    headings.push_back(schema[swept.input].name + " [" + swept.unit->symbol + "]");
  headings.insert(headings.end(), names.begin(), names.end());
  for (const auto& name : names)
    if (with_bases) headings.push_back("change of " + name);
  std::string text = base::join(headings, ",") + "\n";
  for (std::size_t k = 0; k < list.cases.size(); ++k) {
    const auto i_base = list.origins[k].base;
    const Pair pair{results[k], results[i_base]};
    std::vector<std::string> row{io::csv_cell(list.cases[k].name), io::csv_cell(list.cases[i_base].name),
                                 std::string(model::name_of(pair.own.verdict)), cell(pair.own.distance),
                                 io::csv_cell(base::join(all_reasons(summary, k), "; "))};
    if (with_bases) row.push_back(io::csv_cell(held_text(summary, k)));
    for (const auto& swept : list.swept)
      row.push_back(cell(swept.unit->from_si(list.cases[k].values[swept.input])));
    for (std::size_t i = 0; i < names.size(); ++i) row.push_back(pair.figure(i));
    for (std::size_t i = 0; with_bases && i < names.size(); ++i) row.push_back(pair.change(i));
    text += base::join(row, ",") + "\n";
  }
  return text;
}

}  // namespace elrom::fields
