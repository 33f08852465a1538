#pragma once
// Pairs to try, and the oracles that several tests of collisions share.

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include "elrom/base/error.hpp"
#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/pairs.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::particle::test {

using namespace elrom::test;  // test::read_bytes is found here too

using Vector = Eigen::Vector3d;

inline Pairs one_pair(const Vector& velocity_1, const Vector& velocity_2, const Vector& normal,
                      double diameter_1 = 315e-6, double diameter_2 = 315e-6, double density_1 = 1000,
                      double density_2 = 1000) {
  Pairs pairs(1);
  pairs.before.velocity_1.row(0) = velocity_1.transpose().array();
  pairs.before.velocity_2.row(0) = velocity_2.transpose().array();
  pairs.normal.row(0) = normal.normalized().transpose().array();
  pairs.diameter_1 = diameter_1;
  pairs.diameter_2 = diameter_2;
  pairs.density_1 = density_1;
  pairs.density_2 = density_2;
  return pairs;
}

/// The call throws a UsageError that says so.
template <class Call>
void expect_refused(const Call& call, const std::string& text) {
  try {
    call();
    ADD_FAILURE() << "not refused: " << text;
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr(text));
  }
}

inline Vector row(const Components& values, Eigen::Index i = 0) { return values.row(i).matrix().transpose(); }

inline Motion after(const CollisionModel& model, const Pairs& pairs) {
  Impulses impulses(pairs.size());
  model.impulses(pairs, impulses);
  return apply(pairs, impulses);
}

/// Kinetic, of each pair, J.
inline Scalars energy(const Pairs& pairs, const Motion& motion) {
  const auto of = [](const Scalars& d, const Scalars& rho, const Components& v,
                     const Components& w) -> Scalars {
    const Scalars mass = rho * d.cube() * 0.52359877559829887;
    return 0.5 * mass * (v.square().rowwise().sum() + 0.1 * d.square() * w.square().rowwise().sum());
  };
  return of(pairs.diameter_1, pairs.density_1, motion.velocity_1, motion.spin_1) +
         of(pairs.diameter_2, pairs.density_2, motion.velocity_2, motion.spin_2);
}

}  // namespace elrom::particle::test
