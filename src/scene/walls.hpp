#pragma once
// A sphere's path among walls. Internal.

#include "elrom/scene/domain.hpp"
#include "elrom/scene/mover.hpp"

namespace elrom::scene {

/// What a wall makes of a velocity.
[[nodiscard]] inline Vec reflected(const Vec& velocity, const Side& side, const WallLaw& law) {
  const double across = dot(side.normal, velocity);
  const Vec along = velocity - across * side.normal;
  return law.tangential_restitution * along - law.normal_restitution * across * side.normal;
}

/// Moves one sphere for a time, reflecting it where it meets walls. @return how many
struct Path {
  Vec place, velocity;
  int hits = 0;
  bool left = false;  ///< passed an outlet
};
[[nodiscard]] Path follow(const Domain& domain, const WallLaw& law, const Vec& place, const Vec& velocity,
                          double radius, double time);

/// All of them, on straight paths. Spheres that leave are named in state.leaving.
void fly(State& state, const Domain& domain, const WallLaw& law, double dt, int n_threads);

}  // namespace elrom::scene
