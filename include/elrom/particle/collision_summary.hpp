#pragma once
// A set of collisions in an engineer's words: what kinds of collisions, how fast, what they cost.

#include <cstddef>

#include "elrom/particle/collision_set.hpp"

namespace elrom::particle {

/// Of some values; NaN where there are none.
struct Spread {
  double least, mean, most;
};

/// Every pair is of one kind:
///   grazing      the relative velocity and the normal are more than 60 degrees apart (central: 0)
///   head_on      of the others: the velocities are at least 120 degrees apart
///   catching_up  at most 60 degrees apart, or one sphere is at rest
///   crossing     between
struct CollisionSummary {
  static constexpr double grazing_from = 60, head_on_from = 120, catching_up_to = 60;  ///< degrees

  std::size_t n_pairs = 0;
  std::size_t head_on = 0, crossing = 0, catching_up = 0, grazing = 0;
  Spread speed, speed_after;                  ///< of spheres, m/s
  Spread relative_speed;                      ///< of centres, m/s
  Spread impact_angle;                        ///< between relative velocity and normal, degrees
  Spread diameter_1, diameter_2;              ///< m
  Spread overlap_share;                       ///< greatest overlap over the smaller diameter
  Spread duration;                            ///< of pairs that touched, s
  Spread surface_speed, surface_speed_after;  ///< r w of spheres, m/s
  double energy_lost = 0;     ///< share of the kinetic energy of all pairs together; negative: gained
  double momentum_error = 0;  ///< greatest |change| / (|p1| + |p2|) of a pair
  std::size_t started_overlapped = 0;
  std::size_t capped = 0;  ///< a sphere leaves at the speed cap
  std::size_t stayed = 0;  ///< that had not parted when the solver gave up
  std::size_t never_met = 0;
};

[[nodiscard]] CollisionSummary summarise(const CollisionSet& set);

}  // namespace elrom::particle
