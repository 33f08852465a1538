#pragma once
// A collision model asked for one pair at a time, without allocating. Internal.

#include "elrom/particle/collision_model.hpp"
#include "elrom/scene/particles.hpp"

namespace elrom::scene {

class OneCollision {
 public:
  explicit OneCollision(const particle::CollisionModel& model) : model_(model), pairs_(1), impulses_(1) {}

  /// Collides spheres i and j. @param normal unit vector from i to j
  void apply(Particles& p, std::size_t i, std::size_t j, const Vec& normal) {
    put(pairs_.before.velocity_1, get(p.velocity, i)), put(pairs_.before.velocity_2, get(p.velocity, j));
    if (p.rotates) put(pairs_.before.spin_1, get(p.spin, i)), put(pairs_.before.spin_2, get(p.spin, j));
    put(pairs_.normal, normal);
    pairs_.diameter_1[0] = p.diameter[i], pairs_.diameter_2[0] = p.diameter[j];
    pairs_.density_1[0] = p.density[i], pairs_.density_2[0] = p.density[j];
    if (p.are_parcels) pairs_.density_1[0] *= p.weight[i], pairs_.density_2[0] *= p.weight[j];
    model_.impulses(pairs_, impulses_);
    set(p.velocity, i, get(p.velocity, i) + (1 / p.mass[i]) * row(impulses_.linear_1));
    set(p.velocity, j, get(p.velocity, j) + (1 / p.mass[j]) * row(impulses_.linear_2));
    if (!p.rotates) return;
    const auto inertia = [&](std::size_t k) { return 0.1 * p.mass[k] * p.diameter[k] * p.diameter[k]; };
    set(p.spin, i, get(p.spin, i) + (1 / inertia(i)) * row(impulses_.angular_1));
    set(p.spin, j, get(p.spin, j) + (1 / inertia(j)) * row(impulses_.angular_2));
  }

 private:
  static void put(particle::Components& to, const Vec& v) { to(0, 0) = v.x, to(0, 1) = v.y, to(0, 2) = v.z; }
  static Vec row(const particle::Components& from) { return {from(0, 0), from(0, 1), from(0, 2)}; }

  const particle::CollisionModel& model_;
  particle::Pairs pairs_;
  particle::Impulses impulses_;
};

}  // namespace elrom::scene
