#include "elrom/report/metrics.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "elrom/base/random.hpp"

namespace elrom::report {
namespace {

// Two cases, two planes of two columns. Means of the cells: 2, 10, 4, 10; the second column never varies.
MatrixF small_training_set() {
  MatrixF values(2, 4);
  values << 1, 10, 3, 10,  //
      3, 10, 5, 10;
  return values;
}

TEST(Metrics, TrainingStatisticsMatchHandValues) {
  const auto statistics = training_statistics(small_training_set(), 2);

  EXPECT_THAT(statistics.cell_mean, testing::ElementsAre(2, 10, 4, 10));
  // Column 0 holds 1, 3, 3, 5: mean 3, variance (4 + 0 + 0 + 4) / 4 = 2.
  EXPECT_DOUBLE_EQ(statistics.column_sigma[0], std::sqrt(2.0));
  EXPECT_DOUBLE_EQ(statistics.column_sigma[1], 0.0);
}

TEST(Metrics, ScoresMatchHandValues) {
  const auto statistics = training_statistics(small_training_set(), 2);
  const std::vector<float> truth{4, 11, 4, 9}, prediction{3, 11, 5, 11};

  const auto sums = error_sums(truth, prediction, statistics);

  // Errors -1, 0, 1, 2; departures from the mean 2, 1, 0, -1.
  EXPECT_DOUBLE_EQ(sums.nrmse(), std::sqrt(6.0 / 6.0));
  EXPECT_DOUBLE_EQ(sums.rmse(), std::sqrt(6.0 / 4.0));
  EXPECT_DOUBLE_EQ(sums.standardised_mse(), (1.0 / 2 + 1.0 / 2) / 2);  // the constant column is left out
  // Truth has mean 7, spread 9 + 16 + 9 + 4 = 38.
  EXPECT_DOUBLE_EQ(sums.r2(), 1 - 6.0 / 38.0);
}

TEST(Metrics, PredictingTheTrainingMeanGivesNrmseOne) {
  const auto statistics = training_statistics(small_training_set(), 2);
  const std::vector<float> truth{7, 1, -3, 12}, mean{2, 10, 4, 10};

  EXPECT_DOUBLE_EQ(error_sums(truth, mean, statistics).nrmse(), 1.0);
  EXPECT_DOUBLE_EQ(error_sums(truth, truth, statistics).nrmse(), 0.0);
}

TEST(Metrics, PooledSumsEqualTheSumsOfEverythingAtOnce) {
  const auto statistics = training_statistics(small_training_set(), 2);
  const std::vector<float> truth{4, 11, 4, 9}, prediction{3, 11, 5, 11};
  const std::vector<std::size_t> first{0, 1}, second{2, 3};

  auto pooled = error_sums(truth, prediction, statistics, first);
  pooled += error_sums(truth, prediction, statistics, second);

  const auto whole = error_sums(truth, prediction, statistics);
  EXPECT_EQ(pooled.n, whole.n);
  EXPECT_DOUBLE_EQ(pooled.nrmse(), whole.nrmse());
  EXPECT_NEAR(pooled.r2(), whole.r2(), 1e-14);
  EXPECT_DOUBLE_EQ(pooled.standardised_mse(), whole.standardised_mse());
}

TEST(Metrics, NothingScoredIsUndefinedRatherThanPerfect) {
  const ErrorSums empty;

  EXPECT_TRUE(std::isnan(empty.nrmse()));
  EXPECT_TRUE(std::isnan(empty.rmse()));
  EXPECT_TRUE(std::isnan(empty.r2()));
  EXPECT_TRUE(std::isnan(empty.standardised_mse()));
}

TEST(Metrics, WorstCellPrefersWhatIsNotFinite) {
  const float not_a_number = std::numeric_limits<float>::quiet_NaN();

  EXPECT_EQ(worst_cell(std::vector<float>{1, 2, 3}, std::vector<float>{1, 5, 2}).cell, 1u);
  EXPECT_EQ(worst_cell(std::vector<float>{1, 2, 3}, std::vector<float>{1, 5, not_a_number}).cell, 2u);
}

TEST(Metrics, CoveredShareCountsTheEdgeAsCovered) {
  const std::vector<float> truth{0, 0, 0, 0}, prediction{0, 1, 2, -3}, half_width{0, 1, 1, 4};

  EXPECT_DOUBLE_EQ(covered_share(truth, prediction, half_width), 0.75);
}

TEST(Metrics, NoiseEnergyIsTheUnbiasedVarianceSummedOverCells) {
  MatrixF runs(3, 2);
  runs << 1, 5,  //
      2, 5,      //
      3, 8;

  // Variances 1 and (1 + 1 + 4) / 2 = 3.
  EXPECT_DOUBLE_EQ(noise_energy(runs), 4.0);
}

TEST(Metrics, NoiseTakenOffRecoversTheErrorAgainstTheCleanTruth) {
  // A clean field, a prediction off by 0.3, and truths that carry noise of variance 1: taking the noise off
  // must give the NRMSE against the clean field, which is known.
  base::Random random{base::Seed(5)};
  constexpr int n = 200000;
  std::vector<float> truth(n), prediction(n);
  TrainingStatistics statistics;
  statistics.cell_mean.assign(n, 0.0);
  statistics.column_sigma.assign(1, 1.0);
  for (int i = 0; i < n; ++i) {
    const double clean = i % 2 == 0 ? 2.0 : -2.0;
    truth[i] = static_cast<float>(clean + random.normal());
    prediction[i] = static_cast<float>(clean + 0.3);
  }

  const auto sums = error_sums(truth, prediction, statistics);

  constexpr double sampling_error = 0.02;  // of a difference of energies, over 200,000 cells
  EXPECT_NEAR(nrmse_without_noise(sums, n * 1.0), 0.3 / 2.0, sampling_error);
  EXPECT_GT(sums.nrmse(), 0.4);
}

TEST(Metrics, NoiseFollowsAPowerOfTheLoad) {
  const std::vector<double> measured{0.5, 1.0}, energies{1.0, 4.0}, loads{0.5, 1.0, 0.25};

  // Four times the energy at twice the load: the square of the load.
  EXPECT_THAT(noise_at_loads(measured, energies, loads),
              testing::ElementsAre(testing::DoubleNear(1, 1e-12), testing::DoubleNear(4, 1e-12),
                                   testing::DoubleNear(0.25, 1e-12)));
}

TEST(Metrics, NoiseAtOneMeasuredLoadStandsForAll) {
  const std::vector<double> loads{0.5, 1.0};

  EXPECT_THAT(noise_at_loads(std::vector{0.7}, std::vector{3.0}, loads), testing::ElementsAre(3, 3));
  EXPECT_THAT(noise_at_loads(std::vector{0.7, 0.7}, std::vector{2.0, 4.0}, loads),
              testing::ElementsAre(3, 3));
  EXPECT_THAT(noise_at_loads(std::vector{0.7, 0.9}, std::vector{0.0, 4.0}, loads),
              testing::ElementsAre(2, 2));
}

TEST(Metrics, MoreNoiseThanErrorIsNoPerfectModel) {
  EXPECT_TRUE(std::isnan(nrmse_without_noise({.n = 1, .error = 1, .departure = 4}, 2)));
  EXPECT_TRUE(std::isnan(nrmse_without_noise({.n = 1, .error = 1, .departure = 2}, 2)));
}

TEST(CaseSpan, RepresentsItsOwnCasesAndCombinations) {
  MatrixF values(3, 4);
  values << 1, 0, 2, 0,  //
      0, 3, 1, 0,        //
      2, 1, 0, 0;
  const CaseSpan span(values);

  EXPECT_EQ(span.n_modes(), 2u);  // three centred cases
  const std::vector<float> own{0, 3, 1, 0};
  EXPECT_NEAR(span.residuals(own).back(), 0.0, 1e-10);
  const std::vector<float> outside{1, 4.0F / 3, 1, 5};  // the mean, and 5 where every case is 0
  EXPECT_NEAR(span.residuals(outside).back(), 25.0, 1e-5);
}

TEST(CaseSpan, ResidualNeverGrowsWithTheRank) {
  base::Random random{base::Seed(7)};
  MatrixF values(6, 30);
  for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = static_cast<float>(random.normal());
  std::vector<float> truth(30);
  for (auto& value : truth) value = static_cast<float>(random.normal());

  const auto residuals = CaseSpan(values).residuals(truth);

  EXPECT_EQ(residuals.size(), 6u);
  EXPECT_TRUE(std::is_sorted(residuals.rbegin(), residuals.rend()));
}

TEST(ErrorBudget, PartsSumToTheSquaredNrmse) {
  const ErrorSums sums{.n = 10, .error = 6, .departure = 10};

  const auto budget = error_budget(sums, 2, 3.5);

  EXPECT_DOUBLE_EQ(budget.noise, 0.2);
  EXPECT_DOUBLE_EQ(budget.compression, 0.15);
  EXPECT_NEAR(budget.regression, 0.25, 1e-15);
  EXPECT_DOUBLE_EQ(budget.nrmse_squared(), 0.6);
}

}  // namespace
}  // namespace elrom::report
