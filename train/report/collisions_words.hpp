#pragma once
// How the figures of collision models are written, in the terminal and on the page.

#include <string>

#include "elrom/report/collisions.hpp"

namespace elrom::report {

/// "0.00123 m/s"
[[nodiscard]] std::string speed_text(double metres_per_second);
/// "63.1 ns"
[[nodiscard]] std::string call_text(double seconds);
/// What to think of a model's errors on these pairs.
[[nodiscard]] std::string mark_text(const CollisionReport& report, const CollisionModelReport& model);

}  // namespace elrom::report
