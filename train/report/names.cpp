#include "names.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/field/catalogue.hpp"
#include "elrom/methods/catalogue.hpp"

namespace elrom::report {

std::string method_label(const std::string& name) {
  const auto* known = methods::find_method(name);
  return known == nullptr ? name : known->label;
}

std::string field_label(const std::string& name) {
  auto label = name;
  std::replace(label.begin(), label.end(), '_', ' ');
  return label;
}

std::string score_text(double value, int decimals) {
  return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
}

std::string percent_text(double share, int decimals) {
  return std::isfinite(share) ? fmt::format("{:.{}f} %", 100 * share, decimals) : "-";
}

std::string value_text(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "-";
  return unit == "1" || unit.empty() ? fmt::format("{:.4g}", value) : fmt::format("{:.4g} {}", value, unit);
}

std::vector<std::string> in_usual_order(const std::map<std::string, double>& by_field) {
  std::vector<std::string> names;
  for (const auto& info : field::standard_fields())
    if (by_field.contains(info.name)) names.push_back(info.name);
  for (const auto& [name, value] : by_field)
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  return names;
}

ShownUnit shown_unit(const std::string& field, const std::string& unit) {
  if (unit == "m" && field.ends_with("diameter")) return {"µm", 1e6};
  return {unit, 1};
}

std::string gain_text(const Gain& gain) {
  if (!std::isfinite(gain.value)) return "-";
  auto text = fmt::format("{:+.1f} %", 100 * gain.value);
  if (gain.interval)
    text += fmt::format(" [{:.1f}, {:.1f}]", 100 * gain.interval->low, 100 * gain.interval->high);
  return text;
}

std::string case_text(const std::string& name, double load) {
  return std::isfinite(load) ? fmt::format("{} ({:.0f} % load)", name, 100 * load) : name;
}

bool has_loads(const AccuracyReport& report) {
  return std::ranges::any_of(report.cases, [](const ScoredCase& one) { return std::isfinite(one.load); });
}

}  // namespace elrom::report
