#include "elrom/math/kernel.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace elrom::math {
namespace {

constexpr Covariance every[] = {Covariance::exponential, Covariance::matern32, Covariance::matern52,
                                Covariance::gaussian};

TEST(Kernel, IsOneAtZeroAndZeroFarAway) {
  for (Covariance kind : every) {
    EXPECT_DOUBLE_EQ(covariance(kind, 0), 1) << name_of(kind);
    EXPECT_EQ(covariance(kind, 1e12), 0) << name_of(kind);
  }
}

TEST(Kernel, OfAllPairsIsThatOfEachPair) {
  MatrixD cases(5, 2);
  cases << 0, 0, 0.3, -0.2, 0.8, 0.1, 9, 30, 1e150, -1e150;
  for (Covariance kind : every) {
    const Covariances c = covariances(kind, cases);

    for (Eigen::Index i = 0; i < 5; ++i)
      for (Eigen::Index j = 0; j < 5; ++j) {
        const double r = (cases.row(i) - cases.row(j)).norm();
        EXPECT_NEAR(c.squares(i, j), r * r, 1e-12 * r * r) << name_of(kind);
        EXPECT_NEAR(c.k(i, j), covariance(kind, r), 1e-15) << name_of(kind);
      }
    EXPECT_EQ(c.k(0, 4), 0) << name_of(kind);
  }
}

TEST(Kernel, SlopeEqualsDifferences) {
  MatrixD cases(3, 1);
  cases << 0, 0.8, 1e7;
  for (Covariance kind : every) {
    const Eigen::MatrixXd slope = covariances(kind, cases).slope;

    const double r = 0.8, h = 1e-6;
    const double by_differences = (covariance(kind, r + h) - covariance(kind, r - h)) / (2 * h);
    EXPECT_NEAR(slope(0, 1) * r, by_differences, 1e-9) << name_of(kind);
    EXPECT_EQ(slope(0, 2), 0) << name_of(kind);
    EXPECT_TRUE(slope.allFinite()) << name_of(kind);
  }
}

TEST(Kernel, NamesReadBack) {
  for (Covariance kind : every) EXPECT_EQ(covariance_of(name_of(kind)), kind);
}

TEST(Kernel, SquaredDistancesMatchHandValues) {
  MatrixD a(1, 2), b(2, 2);
  a << 1, 2;
  b << 1, 2, 4, 6;

  const Eigen::MatrixXd d = squared_distances(a, b);

  EXPECT_DOUBLE_EQ(d(0, 0), 0);
  EXPECT_DOUBLE_EQ(d(0, 1), 25);
}

}  // namespace
}  // namespace elrom::math
