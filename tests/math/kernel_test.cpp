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

TEST(Kernel, SlopeEqualsDifferences) {
  for (Covariance kind : every) {
    const double r = 0.8, h = 1e-6;
    const double slope = (covariance(kind, r + h) - covariance(kind, r - h)) / (2 * h);
    EXPECT_NEAR(covariance_slope(kind, r) * r, slope, 1e-9) << name_of(kind);
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
