#include "physics_checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "elrom/base/text.hpp"
#include "elrom/model/operating_line.hpp"
#include "robust.hpp"

namespace elrom::ingest {
namespace {

constexpr std::size_t fewest_others = 8;
constexpr double infinity = std::numeric_limits<double>::infinity();
// Standard deviation over the median and the 80th percentile of absolute deviations, of normally distributed
// values. The second: what follows the load has long tails.
constexpr double by_median = 1.4826, by_tail = 0.7803;

constexpr auto all_checks = {&read_mesh_cover, &read_empty_fields, &read_flow_direction,
                             &read_continuity, &read_gas_balance,  &read_solids_inventory,
                             &read_roughness};

double scaled(const Reading& reading) {
  return reading.logarithmic ? std::log(reading.value) : reading.value;
}

struct Range {
  double low = 0, high = 0;
};

Range usual_range(const std::vector<double>& others, const Reading& reading) {
  const double middle = median(others);
  std::vector<double> deviations;
  for (const double value : others) deviations.push_back(std::abs(value - middle));
  const double spread =
      std::max({by_median * median(deviations), by_tail * quantile(deviations, 0.8), reading.least_spread});
  const double reach = reading.reach * model::growth_for_few(others.size(), reading.few_cases) * spread;
  const double low = reading.only_above ? -infinity : middle - reach, high = middle + reach;
  if (!reading.logarithmic) return {low, high};
  return {reading.only_above ? low : std::exp(low), std::exp(high)};
}

/// Scaled values of every reading, by what it is, with the case that each belongs to.
using Table = std::map<std::string, std::vector<std::pair<std::size_t, double>>>;

Table tabulate(std::span<const CaseSummary> cases) {
  Table table;
  for (std::size_t i = 0; i < cases.size(); ++i)
    for (const auto& reading : cases[i].readings) table[reading.what].emplace_back(i, scaled(reading));
  return table;
}

std::optional<PhysicsFinding> judge(std::size_t i_case, const Reading& reading, const Table& table) {
  if (reading.value < reading.low || reading.value > reading.high)
    return PhysicsFinding{i_case, reading, true, reading.low, reading.high, 0};
  std::vector<double> others;
  for (const auto& [i, value] : table.at(reading.what))
    if (i != i_case) others.push_back(value);
  if (others.size() < fewest_others) return std::nullopt;
  const auto usual = usual_range(others, reading);
  if (reading.value >= usual.low && reading.value <= usual.high) return std::nullopt;
  return PhysicsFinding{i_case, reading, false, usual.low, usual.high, others.size()};
}

}  // namespace

std::span<const float> PhysicsView::field(std::string_view name) const {
  for (std::size_t f = 0; f < one.fields.size(); ++f) {
    if (one.fields[f].name != name) continue;
    const auto row = static_cast<Eigen::Index>(f);
    return {one.values.row(row).data(), static_cast<std::size_t>(one.values.cols())};
  }
  return {};
}

std::vector<Reading> read_physics(const CheckedCase& one) {
  PhysicsView view{.one = one, .audit = {}};
  const bool has_inputs = one.schema && one.inputs.size() == one.schema->size();
  if (one.mesh && has_inputs && one.mesh->volume.size() == one.mesh->n_cells()) {
    const std::optional<field::Furnace> furnace = one.furnace ? std::optional(*one.furnace) : std::nullopt;
    view.audit = model::audit({.mesh = *one.mesh,
                               .schema = *one.schema,
                               .inputs = one.inputs,
                               .fields = one.fields,
                               .values = {one.values.data(), static_cast<std::size_t>(one.values.size())}},
                              model::audit_settings(furnace));
  }
  std::vector<Reading> readings;
  for (const auto& check : all_checks) {
    for (auto& reading : check(view)) {
      if (std::isfinite(reading.value) && (!reading.logarithmic || reading.value > 0))
        readings.push_back(std::move(reading));
    }
  }
  return readings;
}

std::vector<PhysicsFinding> judge_physics(std::span<const CaseSummary> cases) {
  const auto table = tabulate(cases);
  std::vector<PhysicsFinding> findings;
  for (std::size_t i = 0; i < cases.size(); ++i) {
    for (const auto& reading : cases[i].readings)
      if (auto finding = judge(i, reading, table)) findings.push_back(std::move(*finding));
  }
  return findings;
}

std::string in_words(const PhysicsFinding& finding) {
  const auto number = [](double value) { return base::rounded(value, 3); };
  const auto& [i_case, reading, impossible, low, high, n_others] = finding;
  std::string text = reading.what + " is " + number(reading.value) + ", ";
  text += impossible ? "plausible " : fmt::format("in {} other cases ", n_others);
  if (!std::isfinite(low)) return text + "up to " + number(high);
  if (!std::isfinite(high)) return text + "from " + number(low);
  return text + number(low) + " to " + number(high);
}

}  // namespace elrom::ingest
