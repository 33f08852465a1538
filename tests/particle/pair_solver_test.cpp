#include "elrom/particle/pair_solver.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "elrom/particle/protocol.hpp"
#include "particle/pairs_for_tests.hpp"

namespace elrom::particle {
namespace {

using test::energy;
using test::one_pair;
using testing::DoubleNear;

// Central, equal spheres, linear: v'_A = (1-e)/2 v_A + (1+e)/2 v_B (particles.md 1), at every e.
TEST(PairSolver, GivesTheClosedFormOfACentralLinearContact) {
  for (const double e : {1.0, 0.95, 0.9, 0.5, 0.1, 0.01, 0.0}) {
    auto pairs = one_pair({3, 0, 0}, {-2, 0, 0}, {1, 0, 0});
    const auto parting = collide(pairs, {.restitution = e, .stiffness = 1e5});
    EXPECT_NEAR(parting.after.velocity_1(0, 0), (1 - e) / 2 * 3 + (1 + e) / 2 * -2, 5e-5) << e;
    EXPECT_NEAR(parting.after.velocity_2(0, 0), (1 + e) / 2 * 3 + (1 - e) / 2 * -2, 5e-5) << e;
  }
}

TEST(PairSolver, LastsAsLongAsTheOscillatorsHalfPeriod) {
  auto pairs = one_pair({3, 0, 0}, {-2, 0, 0}, {1, 0, 0});
  const ContactLaw law{.restitution = 0.9, .stiffness = 1e5};
  const double m12 = sphere_mass(315e-6, 1000) / 2;
  const double tau =
      std::sqrt(m12 / 1e5) * std::sqrt(std::pow(std::numbers::pi, 2) + std::pow(std::log(0.9), 2));
  EXPECT_NEAR(collide(pairs, law).duration[0] / tau, 1, 1e-5);
}

}  // namespace
}  // namespace elrom::particle
