#include "race.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace elrom::methods {
namespace {

using Rounds = std::vector<std::vector<std::size_t>>;

/// 25 cases that all show the same: the blend would gain 2.5 by half of the candidate.
Shown alike(double squares) {
  return {Eigen::MatrixXd::Constant(25, 1, 0.2), Eigen::VectorXd::Constant(1, 10), squares};
}

TEST(Race, EveryFoldHasOneRound) {
  EXPECT_EQ(rounds_of(6), (Rounds{{3}, {1, 4}, {0, 2, 5}}));
  EXPECT_EQ(rounds_of(2), (Rounds{{1}, {0}}));
  EXPECT_EQ(rounds_of(1), (Rounds{{0}}));
}

TEST(Race, AGainIsComparedWithOneThatIsFollowedByATenth) {
  EXPECT_TRUE(may_gain(alike(1249), 0.01));
  EXPECT_FALSE(may_gain(alike(1251), 0.01));
  EXPECT_FALSE(may_gain(alike(1249), 0.02));
}

TEST(Race, AWeightIsNeverAboveOne) {
  auto shown = alike(0);
  shown.departures[0] = 4;  // x = 5: gains 2 * 5 - 4 = 6, not 25 / 4
  shown.squares = 6.1 / 0.002;

  EXPECT_FALSE(may_gain(shown, 0.01));
}

TEST(Race, WhatWouldHaveNextToNoWeightGainsNothing) {
  auto shown = alike(1e-9);
  shown.departures[0] = 51;  // 5 / 51 is below a tenth

  EXPECT_FALSE(may_gain(shown, 0.01));
}

TEST(Race, BandsOfColumnsAddUp) {
  Shown shown = alike(1251);
  EXPECT_FALSE(may_gain(shown, 0.01));
  shown.gains.conservativeResizeLike(Eigen::MatrixXd::Constant(25, 2, 0.2));
  shown.departures = Eigen::Vector2d(10, 10);

  EXPECT_TRUE(may_gain(shown, 0.01));
}

TEST(Race, CasesThatDifferMayGainByTwoStandardErrors) {
  Shown shown{Eigen::MatrixXd(26, 1), Eigen::VectorXd::Constant(1, 20), 0};
  for (Eigen::Index i = 0; i < 26; ++i) shown.gains(i, 0) = i % 2 == 0 ? 1 : -1;
  const double most = 2 * std::sqrt(26.0);  // x = 0 as measured, deviation 1
  const double gain = most * most / 20;

  shown.squares = 0.99 * gain / 0.002;
  EXPECT_TRUE(may_gain(shown, 0.01));
  shown.squares = 1.01 * gain / 0.002;
  EXPECT_FALSE(may_gain(shown, 0.01));
}

TEST(Race, FewCasesSayNothing) {
  const Shown few{Eigen::MatrixXd::Constant(23, 1, -1), Eigen::VectorXd::Ones(1), 1};

  EXPECT_TRUE(may_gain(few, 0.01));
}

}  // namespace
}  // namespace elrom::methods
