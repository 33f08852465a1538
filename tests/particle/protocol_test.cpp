#include "elrom/particle/protocol.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "particle/pairs_for_tests.hpp"

namespace elrom::particle {
namespace {

using test::expect_refused;
using test::row;

Scalars length(const Components& values) { return values.square().rowwise().sum().sqrt(); }

Protocol document() { return {.kind = ProtocolKind::document}; }

// Aimed at one point from where they touch at one time: the relative velocity is the normal's.
TEST(Protocol, DocumentDrawsCentralCollisions) {
  const auto pairs = draw_pairs(document(), 1, 0, 200);
  for (Eigen::Index i = 0; i < 200; ++i) {
    const test::Vector relative = row(pairs.before.velocity_1, i) - row(pairs.before.velocity_2, i);
    EXPECT_NEAR((relative.normalized() - row(pairs.normal, i)).norm(), 0, 1e-12);
  }
  EXPECT_EQ(pairs.overlap.maxCoeff(), 0);
  EXPECT_EQ(pairs.before.spin_1.abs().maxCoeff(), 0);
}

// Theta uniform in [0, pi): |cos theta| has mean 2/pi, on the sphere it would be 1/2.
TEST(Protocol, DocumentsDirectionsCrowdAtThePoles) {
  const auto pairs = draw_pairs(document(), 1, 0, 20000);
  const Scalars cosine = (pairs.before.velocity_1.col(2) / length(pairs.before.velocity_1)).abs();
  EXPECT_NEAR(cosine.mean(), 2 / std::numbers::pi, 0.01);
}

TEST(Protocol, GeneralsDirectionsAreUniformOnTheSphere) {
  const auto pairs = draw_pairs({}, 1, 0, 20000);
  const Scalars cosine = (pairs.before.velocity_1.col(2) / length(pairs.before.velocity_1)).abs();
  EXPECT_NEAR(cosine.mean(), 0.5, 0.01);
}

// Uniform on the disc: the squared sine of the impact angle is uniform, and every pair closes in.
TEST(Protocol, GeneralsImpactPointsAreUniformOnTheDisc) {
  const auto pairs = draw_pairs({}, 1, 0, 20000);
  const Components relative = pairs.before.velocity_1 - pairs.before.velocity_2;
  const Scalars cosine = (relative * pairs.normal).rowwise().sum() / length(relative);
  EXPECT_GT(cosine.minCoeff(), 0);
  const Scalars sine_squared = 1 - cosine.square();
  EXPECT_NEAR(sine_squared.mean(), 0.5, 0.01);
  EXPECT_NEAR((sine_squared - 0.5).square().mean(), 1.0 / 12, 0.002);
  EXPECT_NEAR((length(pairs.normal) - 1).abs().maxCoeff(), 0, 1e-12);
}

TEST(Protocol, KeepsToItsRanges) {
  const Protocol protocol{.speed = {2, 3}, .diameter_1 = {1e-4, 2e-4}, .spin_speed = 5};
  const auto pairs = draw_pairs(protocol, 1, 0, 5000);
  const auto speed = length(pairs.before.velocity_2);
  EXPECT_GE(speed.minCoeff(), 2 - 1e-12);
  EXPECT_LE(speed.maxCoeff(), 3 + 1e-12);
  EXPECT_NEAR(speed.mean(), 2.5, 0.02);
  EXPECT_GE(pairs.diameter_1.minCoeff(), 1e-4);
  EXPECT_LE(pairs.diameter_1.maxCoeff(), 2e-4);
  const Scalars surface = length(pairs.before.spin_1) * pairs.diameter_1 / 2;
  EXPECT_LE(surface.maxCoeff(), 5 + 1e-12);
  EXPECT_NEAR(surface.mean(), 2.5, 0.1);
}

TEST(Protocol, PairsDependOnTheirNumberAlone) {
  const auto all = draw_pairs({}, 7, 0, 100), late = draw_pairs({}, 7, 60, 40);
  EXPECT_TRUE((all.before.velocity_1.bottomRows(40) == late.before.velocity_1).all());
  EXPECT_TRUE((all.normal.bottomRows(40) == late.normal).all());
  EXPECT_FALSE((draw_pairs({}, 8, 0, 100).normal == all.normal).all());
}

// Slow pairs, which start nearer than a diameter from each other, overlap by what is missing.
TEST(Protocol, AnApproachTimeLetsSlowPairsStartOverlapped) {
  auto protocol = document();
  protocol.approach_time = 1e-4;
  const auto pairs = draw_pairs(protocol, 1, 0, 2000);
  const Scalars distance = 1e-4 * length(pairs.before.velocity_1 - pairs.before.velocity_2);
  EXPECT_NEAR((pairs.overlap - (315e-6 - distance).max(0.0)).abs().maxCoeff(), 0, 1e-15);
  EXPECT_GT((pairs.overlap > 0).count(), 10);
}

TEST(Protocol, RefusesWhatCannotBeDrawn) {
  expect_refused([] { Protocol{.speed = {0, 0}}.check(); }, "never meet");
  expect_refused([] { Protocol{.speed = {3, 2}}.check(); }, "speeds");
  expect_refused([] { Protocol{.diameter_1 = {0, 0}}.check(); }, "diameter of sphere 1");
  expect_refused([] { Protocol{.diameter_2 = {2e-4, 1e-4}}.check(); }, "diameter of sphere 2");
  expect_refused([] { Protocol{.density_2 = 0}.check(); }, "density");
  expect_refused([] { Protocol{.spin_speed = -1}.check(); }, "spins");
  expect_refused([] { Protocol{.kind = ProtocolKind::document, .spin_speed = 1}.check(); }, "no spins");
  expect_refused([] { Protocol{.approach_time = 1e-4}.check(); }, "overlapped");
}

}  // namespace
}  // namespace elrom::particle
