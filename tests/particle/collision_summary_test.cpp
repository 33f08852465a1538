#include "elrom/particle/collision_summary.hpp"

#include <gmock/gmock.h>

#include "pairs_for_tests.hpp"

namespace elrom::particle {
namespace {

using test::Vector;

/// Pairs by hand that leave as they came.
CollisionSet set_of(const std::vector<Pairs>& rows) {
  CollisionSet set;
  const auto n = rows.size();
  set.pairs = Pairs(n);
  for (std::size_t k = 0; k < n; ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    set.pairs.before.velocity_1.row(i) = rows[k].before.velocity_1.row(0);
    set.pairs.before.velocity_2.row(i) = rows[k].before.velocity_2.row(0);
    set.pairs.normal.row(i) = rows[k].normal.row(0);
    set.pairs.diameter_1[i] = rows[k].diameter_1[0];
    set.pairs.diameter_2[i] = rows[k].diameter_2[0];
    set.pairs.density_1[i] = rows[k].density_1[0];
    set.pairs.density_2[i] = rows[k].density_2[0];
  }
  set.parting.after = set.pairs.before;
  set.parting.overlap = set.pairs.overlap;
  set.parting.duration = set.pairs.overlap;
  return set;
}

Vector at_degrees(double angle) {
  const double radians = angle * 0.017453292519943295;
  return {std::cos(radians), std::sin(radians), 0};
}

TEST(CollisionSummary, EveryPairIsOfOneKind) {
  const Vector x(1, 0, 0), y(0, 1, 0);
  const auto summary = summarise(set_of({
      test::one_pair(x, -x, x),                    // head-on, central
      test::one_pair(x, 2 * at_degrees(121), x),   // head-on
      test::one_pair(x, y, (x - y).normalized()),  // crossing
      test::one_pair(x, at_degrees(119), x),       // crossing
      test::one_pair(2 * x, x, x),                 // catching up
      test::one_pair(x, Vector(0, 0, 0), x),       // the other one at rest
      test::one_pair(2 * x, at_degrees(59), x),    // catching up
      test::one_pair(x, -x, at_degrees(61)),       // grazing, though head-on
      test::one_pair(2 * x, x, at_degrees(80)),    // grazing, though catching up
      test::one_pair(x, -x, at_degrees(59)),       // not yet grazing
  }));
  EXPECT_EQ(summary.n_pairs, 10u);
  EXPECT_EQ(summary.head_on, 3u);
  EXPECT_EQ(summary.crossing, 2u);
  EXPECT_EQ(summary.catching_up, 3u);
  EXPECT_EQ(summary.grazing, 2u);
  EXPECT_NEAR(summary.impact_angle.least, 0, 1e-12);
  EXPECT_NEAR(summary.impact_angle.most, 80, 1e-12);
}

TEST(CollisionSummary, SpeedsAreOfSpheresAndRelativeOnesOfPairs) {
  const Vector x(1, 0, 0);
  const auto summary = summarise(set_of({test::one_pair(3 * x, -x, x), test::one_pair(6 * x, 2 * x, x)}));
  EXPECT_DOUBLE_EQ(summary.speed.least, 1);
  EXPECT_DOUBLE_EQ(summary.speed.mean, 3);
  EXPECT_DOUBLE_EQ(summary.speed.most, 6);
  EXPECT_DOUBLE_EQ(summary.relative_speed.least, 4);
  EXPECT_DOUBLE_EQ(summary.relative_speed.most, 4);
}

TEST(CollisionSummary, EnergyCountsMassesAndSpins) {
  const Vector x(1, 0, 0);
  // Masses 1 and 2 in the unit of the first's; the second stops, the first comes to spin.
  auto set = set_of({test::one_pair(2 * x, -x, x, 1e-3, 1e-3, 1000, 2000)});
  EXPECT_EQ(summarise(set).energy_lost, 0);
  set.parting.after.velocity_2.setZero();
  EXPECT_NEAR(summarise(set).energy_lost, (0.5 * 2 * 1) / (0.5 * 1 * 4 + 0.5 * 2 * 1), 1e-14);
  set.parting.after.spin_1(0, 2) = 1000;  // w r = 0.5 m/s: 1/2 (2/5 m r^2) w^2 = 0.2 m (w r)^2
  EXPECT_NEAR(summarise(set).energy_lost, (1 - 0.2 * 0.25) / 3, 1e-14);
  EXPECT_DOUBLE_EQ(summarise(set).surface_speed_after.most, 0.5);
  EXPECT_DOUBLE_EQ(summarise(set).surface_speed.most, 0);
}

TEST(CollisionSummary, MomentumErrorIsRelativeToThePairs) {
  const Vector x(1, 0, 0);
  auto set = set_of({test::one_pair(2 * x, -x, x), test::one_pair(x, -x, x)});
  EXPECT_EQ(summarise(set).momentum_error, 0);
  set.parting.after.velocity_1(1, 1) = 0.5;
  EXPECT_NEAR(summarise(set).momentum_error, 0.25, 1e-14);
}

TEST(CollisionSummary, CountsWhatIsOutOfTheOrdinary) {
  const Vector x(1, 0, 0);
  auto set =
      set_of({test::one_pair(2 * x, -x, x, 1e-3, 2e-3), test::one_pair(x, -x, x), test::one_pair(x, -x, x)});
  set.parting.duration << 2e-6, 0, 4e-6;
  set.parting.overlap << 5e-5, 0, 0;
  set.parting.n_stayed = 1;
  set.pairs.overlap[2] = 1e-6;
  const auto plain = summarise(set);
  EXPECT_EQ(plain.never_met, 1u);
  EXPECT_EQ(plain.stayed, 1u);
  EXPECT_EQ(plain.started_overlapped, 1u);
  EXPECT_EQ(plain.capped, 0u);
  EXPECT_DOUBLE_EQ(plain.duration.mean, 3e-6);
  EXPECT_DOUBLE_EQ(plain.overlap_share.most, 0.05);
  set.speed_cap = 2;
  EXPECT_EQ(summarise(set).capped, 1u);
  set.parting.duration.setZero();
  EXPECT_TRUE(std::isnan(summarise(set).duration.mean));
}

}  // namespace
}  // namespace elrom::particle
