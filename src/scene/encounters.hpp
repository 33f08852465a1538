#pragma once
// What becomes of spheres that meet at an instant, with each other or with a wall. Internal.

#include <cmath>
#include <limits>

#include "one_collision.hpp"
#include "walls.hpp"

namespace elrom::scene {

/// Of an event that does not happen.
inline constexpr double never = std::numeric_limits<double>::infinity();

/// False for nearly all spheres that do not touch within a time. One condition, so that no guess is wrong.
[[nodiscard]] inline bool may_meet(const Vec& d, const Vec& w, double reach, double time) {
  return dot(d, d) - reach * reach <= std::max(0.0, -2 * time * dot(d, w));
}

/// First contact of spheres d apart that move by w relative to each other; now for those that overlap and
/// close in.
[[nodiscard]] inline double contact_time(const Vec& d, const Vec& w, double reach) {
  const double closing = dot(d, w);
  if (!(closing < 0)) return never;
  const double gap = dot(d, d) - reach * reach;
  if (gap <= 0) return 0;
  const double speed = dot(w, w), root = closing * closing - speed * gap;
  return root < 0 ? never : gap / (std::sqrt(root) - closing);
}

/// At which two spheres touch, m.
[[nodiscard]] inline double reach_of(const Particles& p, std::size_t i, std::size_t j) {
  return 0.5 * (p.contact_diameter()[i] + p.contact_diameter()[j]);
}

class Encounters {
 public:
  Encounters(const Domain& domain, const MoverSettings& settings)
      : domain_(domain), settings_(settings), hit_(*settings.model) {}

  /// Of spheres that are where they touch. @param now s, of the scene
  void collide(Particles& p, std::size_t i, std::size_t j, double now) {
    const Vec apart = domain_.images().nearest(get(p.place, j) - get(p.place, i));
    const Vec normal = (1 / std::sqrt(dot(apart, apart))) * apart;
    if (is_resting(p, i, now) || is_resting(p, j, now))
      bounce(p, i, j, normal);
    else
      hit_.apply(p, i, j, normal);
    if (p.remembers_hits) p.last_hit[i] = p.last_hit[j] = now;
  }

  /// Of a sphere that is where it touches. @param now s, of the scene
  void meet_wall(State& state, std::size_t i, const Side& side, double now) const {
    auto& p = state.particles;
    const bool is_new = meets(p, i, domain_.bit(side));
    auto law = settings_.walls;
    // A contact that lasts makes no other one resting: a sphere on the floor loses energy to its neighbours.
    if (!is_new && is_resting(p, i, now)) law.normal_restitution = law.tangential_restitution = 1;
    set(p.velocity, i, reflected(get(p.velocity, i), side, law));
    if (!is_new) return;
    if (p.remembers_hits) p.last_hit[i] = now;
    state.count_wall_hits(static_cast<std::size_t>(p.group[i]), 1);
  }

 private:
  // Without loss.
  static void bounce(Particles& p, std::size_t i, std::size_t j, const Vec& normal) {
    const double closing = dot(get(p.velocity, i) - get(p.velocity, j), normal);
    const double impulse = 2 * closing * p.mass[i] * p.mass[j] / (p.mass[i] + p.mass[j]);
    set(p.velocity, i, get(p.velocity, i) - (impulse / p.mass[i]) * normal);
    set(p.velocity, j, get(p.velocity, j) + (impulse / p.mass[j]) * normal);
  }
  [[nodiscard]] bool is_resting(const Particles& p, std::size_t i, double now) const {
    return p.remembers_hits && now - p.last_hit[i] < settings_.contact_time;
  }

  const Domain& domain_;
  MoverSettings settings_;
  OneCollision hit_;
};

}  // namespace elrom::scene
