#pragma once
// Beds that gas carries: what the pressure falls by against what the spheres weigh.

#include <nlohmann/json.hpp>
#include <string>

namespace elrom::benchmark {

/// A straight column of 10 mm x 10 mm, filled to 20 and 80 mm, at some speeds.
[[nodiscard]] nlohmann::ordered_json straight_beds(bool small, const std::string& collisions,
                                                   const std::vector<std::string>& changes);
/// examples/11_small_cfb, 10 s. @param changes of its settings, as elrom-simulate --set
[[nodiscard]] nlohmann::ordered_json small_cfb(bool small, const std::vector<std::string>& changes);

}  // namespace elrom::benchmark
