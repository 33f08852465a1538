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

/// Up to this distance of its centre a sphere still touches a wall that it has met, m. So a hit is the
/// beginning of a contact: a sphere that lies on a wall, or is pressed on it, hits it once, by every model
/// and step. The gap is a hundredth of the diameter, or what forces move a sphere by from rest in a step,
/// where that is more.
[[nodiscard]] double wall_reach(const State& state, std::size_t i, double dt);

/// Notes that a sphere is at a wall. @return whether it did not touch it before
[[nodiscard]] inline bool meets(Particles& p, std::size_t i, std::uint64_t wall) {
  if (!p.remembers_walls) return true;
  const bool is_new = (p.touched[i] & wall) == 0;
  p.touched[i] |= wall;
  return is_new;
}
/// Forgets the walls that a sphere has left behind. @param place of its centre @param dt of a step, s
inline void leave_walls(State& state, std::size_t i, const Domain& domain, const Vec& place, double dt) {
  auto& p = state.particles;
  if (p.remembers_walls && p.touched[i] != 0)
    p.touched[i] = domain.nearer(p.touched[i], place, wall_reach(state, i, dt));
}

struct Flight {
  Vec place, velocity;
  double radius, reach;   ///< m
  std::uint64_t touched;  ///< walls, Domain::bit()
};
/// @param dt of a step, s
[[nodiscard]] Flight flight_of(const State& state, std::size_t i, double dt);

/// Moves one sphere for a time, reflecting it where it meets walls.
struct Path {
  Vec place, velocity;
  std::uint64_t touched;
  int hits = 0;       ///< walls that it did not touch before
  bool left = false;  ///< passed an outlet
};
[[nodiscard]] Path follow(const Domain& domain, const WallLaw& law, const Flight& flight, double time);

/// All of them, on straight paths. Spheres that leave are named in state.leaving.
void fly(State& state, const Domain& domain, const WallLaw& law, double dt, int n_threads);

}  // namespace elrom::scene
