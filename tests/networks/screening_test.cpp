#include "elrom/networks/screening.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "fast_screen.hpp"

namespace elrom::networks {
namespace {

// Cases x planes of smooth columns: column c is a known function of two inputs, with noise growing with c.
ScreeningData smooth_data(std::size_t cases, std::size_t planes, Eigen::Index n_columns) {
  ScreeningData data;
  const auto n = static_cast<Eigen::Index>(cases * planes);
  data.inputs = MatrixF(n, 3);
  data.targets = MatrixF(n, n_columns);
  data.n_planes = planes;
  base::Random random(base::Seed(7));
  for (std::size_t i = 0; i < cases; ++i) {
    const double a = random.uniform(-1.7, 1.7), b = random.uniform(-1.7, 1.7);
    for (std::size_t p = 0; p < planes; ++p) {
      const auto r = static_cast<Eigen::Index>(i * planes + p);
      data.inputs.row(r) << static_cast<float>(a), static_cast<float>(b), static_cast<float>(p) / 3.0F - 1.0F;
      for (Eigen::Index c = 0; c < n_columns; ++c) {
        const double noise = static_cast<double>(c) / static_cast<double>(n_columns);
        data.targets(r, c) = static_cast<float>(std::sqrt(1 - noise * noise) * std::sin(a + 0.5 * b) * 1.4 +
                                                noise * random.normal());
      }
      data.plane.push_back(static_cast<std::int32_t>(p));
      data.case_of.push_back(static_cast<std::int32_t>(i));
      data.part.push_back(i % 10 < 7 ? Part::train : i % 10 < 9 ? Part::validation : Part::test);
    }
  }
  return data;
}

ScreenSettings small_settings() {
  ScreenSettings settings;
  settings.builds = 2;
  settings.max_epochs = 60;
  settings.learning_rate = 1e-2;
  settings.patience = 8;
  settings.batch_size = 30;
  settings.n_units = 6;
  settings.features = 40;
  return settings;
}

TEST(Screening, ErrorRisesWithTheNoiseOfAColumn) {
  const auto data = smooth_data(60, 5, 20);

  const auto result = screen_networks(data, small_settings(), {});

  const auto error = result.column_error();
  EXPECT_LT(error[0], 0.1) << "a smooth column is learnt";
  EXPECT_GT(error[19], 0.6) << "a column of 90 % noise variance is not";
  EXPECT_EQ(result.error.rows(), 5);
  EXPECT_EQ(result.build_error.rows(), 2);
  EXPECT_GT(result.mean_epochs, 1);
  EXPECT_LE(result.mean_epochs, small_settings().max_epochs);
}

TEST(Screening, MeanOverPlanesOfEqualCountIsTheColumnError) {
  const auto data = smooth_data(30, 4, 3);

  const auto result = screen_networks(data, small_settings(), {});

  const Eigen::RowVectorXd mean = result.error.colwise().mean();
  for (Eigen::Index c = 0; c < 3; ++c) {
    EXPECT_NEAR(mean[c], result.column_error()[static_cast<std::size_t>(c)], 1e-9 * mean[c]);
  }
}

TEST(Screening, ShortEpochsTogetherVisitEveryRecordOnce) {
  std::vector<std::uint32_t> together;
  for (std::size_t epoch = 3; epoch < 6; ++epoch) {
    const auto some = epoch_order(base::Seed(1), 0, epoch, 100, 40);
    EXPECT_LE(some.size(), 40U);
    together.insert(together.end(), some.begin(), some.end());
  }

  EXPECT_NE(together, epoch_order(base::Seed(1), 0, 0, 100, 0)) << "a sweep has an order of its own";
  EXPECT_EQ(together, epoch_order(base::Seed(1), 0, 1, 100, 0));
  std::ranges::sort(together);
  EXPECT_EQ(together.back(), 99U);
  EXPECT_EQ(std::ranges::adjacent_find(together), together.end());
}

TEST(Screening, ThreadsDoNotChangeABit) {
  const auto data = smooth_data(30, 4, 300);  // more columns than one crew holds

  const auto one = screen_networks(data, small_settings(), {.n_threads = 1});
  const auto three = screen_networks(data, small_settings(), {.n_threads = 3});

  EXPECT_EQ(one.error, three.error);
  EXPECT_EQ(one.mean_epochs, three.mean_epochs);
}

TEST(Screening, ColumnsDoNotDependOnTheirNeighbours) {
  const auto data = smooth_data(30, 4, 40);
  auto few = data;
  few.targets = data.targets.leftCols(5).eval();

  const auto all = screen_networks(data, small_settings(), {});
  const auto some = screen_networks(few, small_settings(), {});

  EXPECT_EQ(MatrixD(all.error.leftCols(5)), some.error);
}

TEST(Screening, ADivergingLearningRateEndsInALargeFiniteError) {
  auto settings = small_settings();
  settings.learning_rate = 1e30;

  const auto result = screen_networks(smooth_data(20, 2, 3), settings, {});

  EXPECT_TRUE(result.error.allFinite());
}

TEST(Screening, NotANumberTargetsSpoilOnlyTheirColumn) {
  auto data = smooth_data(20, 2, 3);
  data.targets(3, 1) = NAN;
  data.targets(static_cast<Eigen::Index>(data.judging_rows()[0]), 1) = NAN;

  const auto result = screen_networks(data, small_settings(), {});

  EXPECT_EQ(result.column_error()[1], largest_error);
  EXPECT_LT(result.column_error()[0], 1);
}

TEST(Screening, StopsOnRequest) {
  std::stop_source source;
  source.request_stop();

  EXPECT_THROW((void)screen_networks(smooth_data(20, 2, 3), small_settings(), {.stop = source.get_token()}),
               Interrupted);
}

TEST(FastScreen, ResidualsEqualThoseOfRefittingWithoutTheCase) {
  const auto data = smooth_data(6, 4, 2);
  MatrixF features(data.inputs.rows(), 5);
  features << MatrixF::Ones(data.inputs.rows(), 1), data.inputs,
      data.inputs.col(0).cwiseProduct(data.inputs.col(1));
  const double ridge = 0.3;

  const MatrixF squared = leave_one_case_out(features, data.targets, data.case_of, ridge);

  for (std::int32_t left_out = 0; left_out < 6; ++left_out) {
    Eigen::MatrixXd gram = ridge * Eigen::MatrixXd::Identity(5, 5);
    Eigen::MatrixXd moments = Eigen::MatrixXd::Zero(5, 2);
    for (Eigen::Index r = 0; r < features.rows(); ++r) {
      if (data.case_of[static_cast<std::size_t>(r)] == left_out) continue;
      const Eigen::VectorXd f = features.row(r).transpose().cast<double>();
      gram += f * f.transpose();
      moments += f * data.targets.row(r).cast<double>();
    }
    const Eigen::MatrixXd weights = math::Cholesky(gram).solve(moments);
    for (Eigen::Index r = left_out * 4; r < left_out * 4 + 4; ++r) {
      const Eigen::RowVectorXd e =
          data.targets.row(r).cast<double>() - features.row(r).cast<double>() * weights;
      EXPECT_NEAR(squared(r, 0), e[0] * e[0], 1e-4 * (1 + e[0] * e[0]));
      EXPECT_NEAR(squared(r, 1), e[1] * e[1], 1e-4 * (1 + e[1] * e[1]));
    }
  }
}

TEST(FastScreen, RanksColumnsByTheirNoise) {
  const auto result = screen_fast(smooth_data(60, 3, 12), small_settings(), {});

  const auto error = result.column_error();
  EXPECT_LT(error[0], 0.2);
  EXPECT_GT(error[11], 0.5);
  EXPECT_EQ(result.error.rows(), 3);
}

}  // namespace
}  // namespace elrom::networks
