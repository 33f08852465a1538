#include "elrom/particle/exact_model.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "elrom/particle/pair_solver.hpp"
#include "elrom/particle/protocol.hpp"
#include "particle/pairs_for_tests.hpp"

namespace elrom::particle {
namespace {

using test::after;
using test::one_pair;
using test::row;

// v'_A = (1-e)/2 v_A + (1+e)/2 v_B
TEST(ExactModel, GivesTheClosedFormOfACentralCollision) {
  const auto pairs = one_pair({3, 0, 0}, {-2, 0, 0}, {1, 0, 0});
  const auto found = after(ExactModel({.restitution = 0.8, .stiffness = 1}), pairs);
  EXPECT_NEAR(found.velocity_1(0, 0), 0.1 * 3 + 0.9 * -2, 1e-14);
  EXPECT_NEAR(found.velocity_2(0, 0), 0.9 * 3 + 0.1 * -2, 1e-14);
}

// Kharaz's sphere on a wall, sliding: 40 degrees at 3.9 m/s, mu 0.092, e 1 (particles.md 9).
TEST(ExactModel, GivesTheClosedFormOfSliding) {
  const double along = 3.9 * std::sin(40 * std::numbers::pi / 180),
               normal = 3.9 * std::cos(40 * std::numbers::pi / 180);
  const auto pairs = one_pair({along, 0, -normal}, {0, 0, 0}, {0, 0, -1}, 5e-3, 5, 4000, 4000e9);
  const auto found = after(ExactModel({.restitution = 1, .friction = 0.092, .stiffness = 1}), pairs);
  EXPECT_NEAR(found.velocity_1(0, 0) / along, 0.78072, 1e-5);
  EXPECT_NEAR(found.spin_1(0, 1), 549.71, 0.01);
}

// Sticking turns the slip round: c' = -b c.
TEST(ExactModel, SticksWhereFrictionHolds) {
  const auto pairs = one_pair({3, 0.1, 0}, {-2, 0, 0}, {1, 0, 0});
  const auto found = after(
      ExactModel({.restitution = 0.9, .friction = 5, .tangential_restitution = 0.4, .stiffness = 1}), pairs);
  const auto slip = [&](const Motion& m) {
    const double r = 315e-6 / 2;
    // c = v_t - (r1 w1 + r2 w2) x n, along y with n along x: (w x n)_y = w_z
    return m.velocity_2(0, 1) - m.velocity_1(0, 1) - r * (m.spin_1(0, 2) + m.spin_2(0, 2));
  };
  EXPECT_NEAR(slip(found), -0.4 * slip(pairs.before), 1e-13);
}

// Stiff soft spheres that slide throughout do what hard ones do.
TEST(ExactModel, IsTheLimitOfStiffContacts) {
  const auto pairs = draw_pairs({}, 5, 0, 300);
  const ContactLaw law{.restitution = 0.9, .friction = 0.02, .stiffness = 1e10};
  const auto soft = collide(pairs, law).after;
  const auto hard = after(ExactModel(law), pairs);
  EXPECT_LT((soft.velocity_1 - hard.velocity_1).abs().mean(), 3e-3);
}

TEST(ExactModel, LeavesPairsAloneThatPartOrAreNoNumbers) {
  for (const double speed : {-1.0, 0.0, double(NAN), double(INFINITY)}) {
    const auto pairs = one_pair({speed, 0, 0}, {0, 0, 0}, {1, 0, 0});
    Impulses impulses(1);
    ExactModel({.stiffness = 1}).impulses(pairs, impulses);
    EXPECT_EQ(row(impulses.linear_1).norm(), 0) << speed;
    EXPECT_EQ(row(impulses.angular_2).norm(), 0) << speed;
  }
}

}  // namespace
}  // namespace elrom::particle
