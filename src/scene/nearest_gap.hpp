#pragma once
// How near the partners of a sphere are. Internal to scene.

#include <algorithm>
#include <cmath>

namespace elrom::scene {

class NearestGap {
 public:
  /// @param squared of the distance between centres @param reach at which they touch, m
  void see(double squared, double reach) {
    nearest_ = std::min(nearest_, squared - reach * reach), widest_ = std::max(widest_, reach);
  }
  /// No partner is nearer, m: as if the nearest were of the widest pair, which takes one root for all.
  [[nodiscard]] double least() const {
    return std::sqrt(std::max(0.0, nearest_) + widest_ * widest_) - widest_;
  }

 private:
  double nearest_ = HUGE_VAL, widest_ = 0;  // m2, m
};

}  // namespace elrom::scene
