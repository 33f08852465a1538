#pragma once
// Numbers of a report's JSON: what is not known is null.

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace elrom::report {

using Json = nlohmann::ordered_json;

[[nodiscard]] inline Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }
[[nodiscard]] inline Json number(const std::optional<double>& value) {
  return value ? number(*value) : Json();
}

}  // namespace elrom::report
