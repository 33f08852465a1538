#include "field_scale.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elrom/base/random.hpp"
#include "leave_one_out.hpp"

namespace elrom::methods {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Of a smoother that knows nothing but the mean of the others.
MatrixXd mean_alone(Eigen::Index n) { return residual_operation(MatrixXd::Zero(n, n)); }

TEST(FieldScale, AResidualIsTheDepartureFromTheMeanOfTheOthers) {
  const VectorXd y = VectorXd::LinSpaced(4, 1, 7);  // 1, 3, 5, 7

  EXPECT_TRUE((mean_alone(4) * y).isApprox(Eigen::Vector4d(-4, -4.0 / 3, 4.0 / 3, 4), 1e-12));
}

TEST(FieldScale, ErrorsAreThoseOfFieldsOverTheirScales) {
  const MatrixXd y = (MatrixXd(3, 2) << 2, 4, 3, 3, 8, 2).finished();
  const VectorXd scales = Eigen::Vector3d(1, 2, 4);

  const VectorXd errors = scaled_errors(mean_alone(3), y * y.transpose(), scales);

  // Over their scales: (2, 4), (1.5, 1.5), (2, 0.5).
  EXPECT_NEAR(errors[0], std::pow(2 - 1.75, 2) + std::pow(4 - 1, 2), 1e-12);
  EXPECT_NEAR(errors[1], 4 * (std::pow(1.5 - 2, 2) + std::pow(1.5 - 2.25, 2)), 1e-12);
  EXPECT_NEAR(errors[2], 16 * (std::pow(2 - 1.75, 2) + std::pow(0.5 - 2.75, 2)), 1e-12);
}

TEST(FieldScale, FindsThePowerOfWhatTheFieldFollows) {
  constexpr Eigen::Index n = 40, n_cells = 30;
  base::Random random(base::Seed(8));
  MatrixD logs(n, 2);
  MatrixXd y(n, n_cells);
  for (Eigen::Index i = 0; i < n; ++i) {
    logs.row(i) << 0.3 * random.normal(), 0.3 * random.normal();
    for (Eigen::Index c = 0; c < n_cells; ++c)
      y(i, c) = std::exp(1.5 * logs(i, 0)) * (1 + std::sin(static_cast<double>(c)) + 0.05 * random.normal());
  }

  const VectorXd exponents = fit_exponents(mean_alone(n), y * y.transpose(), logs, VectorXd::Zero(2));

  EXPECT_NEAR(exponents[0], 1.5, 0.02);
  EXPECT_NEAR(exponents[1], 0, 0.02);
}

TEST(FieldScale, WhatCasesDoNotTellStaysAtZero) {
  const MatrixXd y = MatrixXd::Ones(5, 3);
  MatrixD logs = MatrixD::Zero(5, 1);  // the same in every case

  EXPECT_NEAR(fit_exponents(mean_alone(5), y * y.transpose(), logs, VectorXd::Ones(1))[0], 0, 1e-3);
}

TEST(Significance, IsTheMeanInItsStandardErrors) {
  EXPECT_NEAR(significance(Eigen::Vector4d(1, 3, 5, 7)), 4 / (std::sqrt(5) / 2), 1e-12);
  EXPECT_EQ(significance(Eigen::Vector3d(0, 0, 0)), 0);
  EXPECT_GT(significance(Eigen::Vector3d(2, 2, 2)), 1e6) << "no scatter at all";
}

}  // namespace
}  // namespace elrom::methods
