#pragma once
// Spheres to try, and what several tests of scenes ask of them.

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "elrom/base/random.hpp"
#include "elrom/particle/exact_model.hpp"
#include "elrom/scene/mover.hpp"
#include "elrom/scene/neighbours.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::scene::test {

using namespace elrom::test;  // test::read_bytes is found here too

constexpr double pi = std::numbers::pi;

inline State empty_state(bool rotates = false) {
  State state;
  state.particles.rotates = rotates;
  state.set_groups(1);
  return state;
}

inline void add(State& state, const Vec& place, const Vec& velocity, double diameter = 1e-3,
                double density = 1000) {
  state.particles.add({place, velocity, diameter, density, state.next_id++});
}

/// n spheres in a cube of this edge, apart from each other, with normal velocities of this scatter.
inline State cloud(std::size_t n, double edge, double diameter, double scatter, std::uint64_t seed = 1,
                   bool rotates = false) {
  State state = empty_state(rotates);
  base::Random random{base::Seed(seed)};
  const auto& x = state.particles.place;
  while (state.particles.size() < n) {
    const Vec place{random.uniform(0, edge), random.uniform(0, edge), random.uniform(0, edge)};
    bool free = true;
    for (std::size_t i = 0; free && i < state.particles.size(); ++i) {
      double squared = 0;
      const Vec d = place - get(x, i);
      for (const double part : {d.x, d.y, d.z}) {
        const double nearest = part - edge * std::nearbyint(part / edge);
        squared += nearest * nearest;
      }
      free = squared > diameter * diameter;
    }
    if (free)
      add(state, place, {scatter * random.normal(), scatter * random.normal(), scatter * random.normal()},
          diameter);
  }
  return state;
}

inline Body box(const Vec& low, const Vec& high, const std::string& name = "box") {
  return body_of({.name = name, .low = low, .high = high});
}
inline Domain periodic_cube(double edge) {
  return Domain({box({}, {edge, edge, edge})}, {}, {}, {"x", "y", "z"});
}

inline MoverSettings hard_spheres(double restitution, int n_threads = 1, double friction = 0) {
  MoverSettings settings;
  settings.collisions = Collisions::helscm;
  settings.law = {.restitution = restitution, .friction = friction, .stiffness = 1e4};
  settings.model = std::make_shared<particle::ExactModel>(settings.law);
  settings.n_threads = n_threads;
  return settings;
}
inline MoverSettings soft_spheres(const particle::ContactLaw& law, int n_threads = 1) {
  MoverSettings settings;
  settings.collisions = Collisions::dem;
  settings.law = law;
  settings.n_threads = n_threads;
  return settings;
}

inline void run(Mover& mover, State& state, double step, int n_steps) {
  for (int k = 0; k < n_steps; ++k) {
    mover.advance(state, step);
    state.time += step;
  }
}

inline void expect_same_bits(const Particles& a, const Particles& b) {
  EXPECT_EQ(a.place, b.place);
  EXPECT_EQ(a.velocity, b.velocity);
  EXPECT_EQ(a.spin, b.spin);
}

}  // namespace elrom::scene::test
