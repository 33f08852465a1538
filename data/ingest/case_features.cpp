#include "case_features.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace elrom::ingest {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
constexpr double gravity = 9.81;             // [m/s2]
constexpr double gas_constant = 287.0;       // of air; flue gas differs by a few per cent [J/(kg K)]
constexpr double furnace_pressure = 101325;  // absolute; a furnace works near the atmosphere's [Pa]
constexpr std::size_t n_ratios = 4;
constexpr std::size_t n_velocities = 7;  // the first measures

double log_of(double value) { return value > 0 && std::isfinite(value) ? std::log(value) : unknown; }

std::pair<double, double> between(double low, double high) { return {std::log(low), std::log(high)}; }

std::string_view measure_name(std::size_t m) {
  constexpr std::array<std::string_view, n_measures> names{"solid_velocity_x (root mean square)",
                                                           "solid_velocity_y (root mean square)",
                                                           "solid_velocity_z (root mean square)",
                                                           "gas_velocity_x (root mean square)",
                                                           "gas_velocity_y (root mean square)",
                                                           "gas_velocity_z (root mean square)",
                                                           "gas_velocity_z (mean rise)",
                                                           "pressure (drop over the height)",
                                                           "solid_diameter (mean)",
                                                           "solid_volume_fraction (solids held)"};
  return names[m];
}

}  // namespace

CaseFeatures::CaseFeatures(const field::InputSchema& schema) : schema_(schema) {
  for (std::size_t i = 0; i < schema.size(); ++i) {
    infos_.push_back({schema[i].name});
    if (schema[i].unit == "kg/s") flows_.push_back(i);
    if (schema[i].unit == "K" && !temperature_) temperature_ = i;
    if (schema[i].unit == "kg" && !inventory_) inventory_ = i;
    if (schema[i].unit == "m" && !size_) size_ = i;
  }
  for (std::size_t m = 0; m < n_measures; ++m) infos_.push_back({std::string(measure_name(m))});
  add_ratios();
  load_features_ = flows_;
  if (flows_.size() < 3) {
    load_features_.clear();
    for (std::size_t m = 0; m < n_velocities; ++m) load_features_.push_back(schema.size() + m);
  }
}

// Wide ranges: they hold for any circulating bed, and are only to catch what is out by a unit.
void CaseFeatures::add_ratios() {
  infos_.push_back({"upward gas velocity against the inlets' flow", between(0.45, 2.2)});
  infos_.push_back(
      {"solids' inventory against the solids in the fields (their density)", between(300, 12000)});
  infos_.push_back({"pressure drop against the weight of the solids", between(0.03, 4)});
  infos_.push_back({"solid_diameter against the solids' size at the inlet", between(0.15, 6)});
}

std::vector<double> CaseFeatures::evaluate(const CaseSummary& summary, const Correction* correction) const {
  auto inputs = summary.inputs;
  auto measures = summary.measures;
  inputs.resize(schema_.size(), unknown);
  if (correction) {
    for (const auto i : correction->inputs) inputs[i] = correction->factor * inputs[i] + correction->offset;
    for (std::size_t m = 0; m < n_measures; ++m) {
      const auto name = field_of(static_cast<Measure>(m));
      const auto& fields = correction->fields;
      if (std::find(fields.begin(), fields.end(), name) != fields.end()) measures[m] *= correction->factor;
    }
  }
  const auto measure = [&](Measure which) { return measures[static_cast<std::size_t>(which)]; };
  const auto input = [&](std::optional<std::size_t> i) { return i ? inputs[*i] : unknown; };
  double flow = flows_.empty() ? unknown : 0;
  for (const auto i : flows_) flow += inputs[i];

  std::vector<double> features;
  features.reserve(infos_.size());
  for (const double value : inputs) features.push_back(log_of(value));
  for (const double value : measures) features.push_back(log_of(value));
  const double density = furnace_pressure / (gas_constant * input(temperature_));
  features.push_back(log_of(measure(Measure::gas_rise) * density * summary.area / flow));
  // Without volumes the solids held are known up to the same
  // factor in every case of a mesh: no absolute density.
  features.push_back(
      log_of(summary.has_volume ? input(inventory_) / measure(Measure::solids_volume) : unknown));
  features.push_back(log_of(measure(Measure::pressure_drop) * summary.area / (gravity * input(inventory_))));
  features.push_back(log_of(measure(Measure::diameter) / input(size_)));
  return features;
}

std::vector<std::size_t> CaseFeatures::touched(const Correction& correction) const {
  std::set<std::size_t> result(correction.inputs.begin(), correction.inputs.end());
  const auto has = [&](Measure m) {
    const auto& fields = correction.fields;
    return std::find(fields.begin(), fields.end(), field_of(m)) != fields.end();
  };
  const auto changes = [&](std::optional<std::size_t> i) { return i && result.contains(*i); };
  const std::size_t ratio = infos_.size() - n_ratios;
  const bool any_flow = std::any_of(flows_.begin(), flows_.end(), [&](std::size_t i) { return changes(i); });
  std::set<std::size_t> ratios;
  if (has(Measure::gas_rise) || any_flow || changes(temperature_)) ratios.insert(ratio);
  if (has(Measure::solids_volume) || changes(inventory_)) ratios.insert(ratio + 1);
  if (has(Measure::pressure_drop) || changes(inventory_)) ratios.insert(ratio + 2);
  if (has(Measure::diameter) || changes(size_)) ratios.insert(ratio + 3);
  for (std::size_t m = 0; m < n_measures; ++m) {
    if (has(static_cast<Measure>(m))) result.insert(schema_.size() + m);
  }
  result.insert(ratios.begin(), ratios.end());
  return {result.begin(), result.end()};
}

}  // namespace elrom::ingest
