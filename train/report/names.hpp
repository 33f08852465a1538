#pragma once
// How methods, fields and numbers are written in reports.

#include <map>
#include <string>
#include <vector>

#include "elrom/report/accuracy.hpp"

namespace elrom::report {

/// "pod_gp" -> "POD + GP"; unknown names stay.
[[nodiscard]] std::string method_label(const std::string& name);
/// "solid_velocity_z" -> "solid velocity z"
[[nodiscard]] std::string field_label(const std::string& name);
/// Three decimals; "-" for what is not known.
[[nodiscard]] std::string score_text(double value, int decimals = 3);
/// "8.3 %" of 0.083; "-" for what is not known.
[[nodiscard]] std::string percent_text(double share, int decimals = 1);
/// Four significant digits with the unit; velocities and pressures as they are, diameters in micrometres.
[[nodiscard]] std::string value_text(double value, const std::string& unit);

/// Names in the usual order (velocities, pressure, diameter, fraction), others after them.
[[nodiscard]] std::vector<std::string> in_usual_order(const std::map<std::string, double>& by_field);

/// Unit to show a field in, and the factor from SI to it.
struct ShownUnit {
  std::string symbol;
  double factor = 1;
};
[[nodiscard]] ShownUnit shown_unit(const std::string& field, const std::string& unit);

/// "+9.9 % [4.1, 14.2]": with its interval, where there is one.
[[nodiscard]] std::string gain_text(const Gain& gain);
/// "load_064 (64 % load)"; the name alone where no load is given.
[[nodiscard]] std::string case_text(const std::string& name, double load);
/// Does any of the scored cases state its load?
[[nodiscard]] bool has_loads(const AccuracyReport& report);

}  // namespace elrom::report
