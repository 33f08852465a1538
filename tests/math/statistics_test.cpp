#include "elrom/math/statistics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace elrom::math {
namespace {

TEST(RunningMoments, MatchHandValues) {
  RunningMoments moments;

  for (double v : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) moments.add(v);

  EXPECT_DOUBLE_EQ(moments.mean(), 5);
  EXPECT_DOUBLE_EQ(moments.deviation(), 2);
}

TEST(RunningMoments, KeepDigitsUnderALargeOffset) {
  RunningMoments moments;

  for (double v : {4.0, 7.0, 13.0, 16.0}) moments.add(1e9 + v);

  EXPECT_DOUBLE_EQ(moments.mean(), 1e9 + 10);
  EXPECT_NEAR(moments.variance(), 22.5, 1e-9);  // the textbook formula loses all digits here
}

TEST(RunningMoments, MergeEqualsOneStream) {
  RunningMoments all, left, right;
  for (int i = 0; i < 10; ++i) {
    const double v = std::sin(i);
    all.add(v);
    (i < 3 ? left : right).add(v);
  }

  left.merge(right);

  EXPECT_EQ(left.count(), all.count());
  EXPECT_NEAR(left.mean(), all.mean(), 1e-15);
  EXPECT_NEAR(left.variance(), all.variance(), 1e-15);
}

TEST(Sum, IsPairwise) {
  const std::vector<double> values(10'000'000, 0.1);  // one running sum is off by 1.6e-4

  EXPECT_NEAR(sum(values), 1e6, 1e-8);
}

TEST(Quantile, InterpolatesBetweenOrderStatistics) {
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0), 1);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 1), 4);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(RobustDeviation, IgnoresOneWildValue) {
  EXPECT_DOUBLE_EQ(median({1, 2, 3, 4, 1e30}), 3);
  EXPECT_DOUBLE_EQ(robust_deviation({1, 2, 3, 4, 1e30}), 1.4826);
}

TEST(ConformalQuantile, TakesTheRankThatKeepsThePromise) {
  const std::vector<double> scores{9, 8, 7, 6, 5, 4, 3, 2, 1};

  EXPECT_EQ(conformal_quantile(scores, 0.5), 5);  // rank ceil(10 * 0.5)
  EXPECT_EQ(conformal_quantile(scores, 0.9), 9);  // rank 9 of 9
  EXPECT_EQ(conformal_quantile(scores, 0.95), std::numeric_limits<double>::infinity());
}

TEST(ColumnMoments, UseTheGivenRowsAlone) {
  MatrixF values(3, 2);
  values << 1, 10, 100, 1000, 3, 30;
  const std::vector<std::size_t> rows{0, 2};

  const ColumnMoments moments = column_moments(values, rows);

  EXPECT_DOUBLE_EQ(moments.mean[0], 2);
  EXPECT_DOUBLE_EQ(moments.mean[1], 20);
  EXPECT_DOUBLE_EQ(moments.deviation[1], 10);
}

TEST(Nrmse, IsTheErrorOverThatOfTheMean) {
  MatrixF values(2, 2);
  values << 1, 2, 3, 4e8F;  // its square is above what float can add 1 to
  const std::vector<float> truth{1, 2, 4}, prediction{1, 4, 3}, mean{2, 2, 2};

  EXPECT_EQ(sum_of_squares(values), 1.0 + 4.0 + 9.0 + 1.6e17);
  EXPECT_EQ(squared_distance(prediction, truth), 5);
  EXPECT_EQ(squared_distance(truth, truth), 0);
  EXPECT_DOUBLE_EQ(nrmse(squared_distance(prediction, truth), squared_distance(mean, truth)), 1);
  EXPECT_DOUBLE_EQ(nrmse(1, 4), 0.5);
}

TEST(Nrmse, OfATruthThatIsTheMeanIsUndefined) {
  EXPECT_TRUE(std::isnan(nrmse(3, 0)));
  EXPECT_EQ(nrmse(3, 0, 0), 0);
  EXPECT_TRUE(std::isnan(nrmse(3, -1)));
}

}  // namespace
}  // namespace elrom::math
