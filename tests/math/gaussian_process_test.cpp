#include "elrom/math/gaussian_process.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "elrom/base/random.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::math {
namespace {

struct SmoothSample {
  MatrixD x{12, 3};
  Eigen::MatrixXd y{12, 2};
  SmoothSample() {
    base::Random random(base::Seed(3).derive("gp"));
    for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = random.normal();
    for (Eigen::Index i = 0; i < y.rows(); ++i) {
      y(i, 0) = std::sin(x(i, 0)) + 0.1 * random.normal();
      y(i, 1) = x(i, 1) - 0.5 * x(i, 0);
    }
  }
};

GpParameters some_parameters() { return {Eigen::Vector3d(1.5, 2.0, 4.0), 1.3, 0.05, Covariance::matern52}; }

TEST(GaussianProcess, ReturnsNoiseFreeDataWithoutVariance) {
  const SmoothSample sample;
  GpParameters parameters = some_parameters();
  parameters.noise_variance = 0;

  const GaussianProcess process(sample.x, sample.y, parameters);

  EXPECT_TRUE(process.mean(sample.x).isApprox(sample.y, 1e-8)) << process.mean(sample.x) << "\n\n"
                                                               << sample.y;
  EXPECT_LT(process.variance(sample.x).maxCoeff(), 1e-8);
}

TEST(GaussianProcess, FarFromDataIsThePrior) {
  const SmoothSample sample;
  const GaussianProcess process(sample.x, sample.y, some_parameters());
  const MatrixD far = MatrixD::Constant(1, 3, 1e6);

  EXPECT_NEAR(process.mean(far).norm(), 0, 1e-12);
  EXPECT_DOUBLE_EQ(process.variance(far)[0], 1.3);
}

TEST(GaussianProcess, LeaveOneOutEqualsRefits) {
  const SmoothSample sample;
  const Eigen::MatrixXd closed =
      GaussianProcess(sample.x, sample.y, some_parameters()).leave_one_out_residuals();

  for (std::size_t left = 0; left < 12; ++left) {
    std::vector<std::size_t> rest = all_rows(12);
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(left));
    const auto i = static_cast<Eigen::Index>(left);
    const MatrixD own = sample.x.row(i), y = sample.y;
    const GaussianProcess refit(take_rows(sample.x, rest), take_rows(y, rest), some_parameters());
    const Eigen::RowVectorXd residual = sample.y.row(i) - refit.mean(own);
    EXPECT_TRUE(residual.isApprox(closed.row(i), 1e-8)) << residual << "\n" << closed.row(i);
  }
}

TEST(GaussianProcess, LikelihoodOfOneDatumIsTheNormalDensity) {
  const MatrixD x = MatrixD::Zero(1, 1);
  const Eigen::MatrixXd y = Eigen::MatrixXd::Constant(1, 1, 0.7);
  Eigen::VectorXd gradient;

  const double value = gp_negative_log_likelihood(x, y, Covariance::matern52,
                                                  Eigen::Vector3d(0, std::log(1.5), std::log(0.5)), gradient);

  const double variance = 2;  // signal and noise
  EXPECT_NEAR(value, 0.5 * std::log(2 * std::numbers::pi * variance) + 0.49 / (2 * variance), 1e-14);
}

TEST(GaussianProcess, LikelihoodGradientEqualsDifferences) {
  const SmoothSample sample;
  Eigen::VectorXd theta(5), gradient, unused;
  theta << 0.3, 0.8, 1.2, 0.1, -2;
  const double h = 1e-6;
  static_cast<void>(gp_negative_log_likelihood(sample.x, sample.y, Covariance::matern52, theta, gradient));

  for (Eigen::Index j = 0; j < theta.size(); ++j) {
    Eigen::VectorXd up = theta, down = theta;
    up[j] += h;
    down[j] -= h;
    const double slope =
        (gp_negative_log_likelihood(sample.x, sample.y, Covariance::matern52, up, unused) -
         gp_negative_log_likelihood(sample.x, sample.y, Covariance::matern52, down, unused)) /
        (2 * h);
    EXPECT_NEAR(gradient[j], slope, 1e-7) << "parameter " << j;
  }
}

TEST(GaussianProcess, FitFindsTheInputThatMatters) {
  base::Random random(base::Seed(5).derive("relevance"));
  MatrixD x(40, 2);
  Eigen::MatrixXd y(40, 1);
  for (Eigen::Index i = 0; i < 40; ++i) {
    x.row(i) << random.normal(), random.normal();
    y(i, 0) = std::sin(2 * x(i, 0));
  }

  const GpParameters found = fit_gp(x, y);

  EXPECT_GT(found.length_scales[1], 10 * found.length_scales[0]);
  EXPECT_LT(found.noise_variance, 1e-3);
}

TEST(GaussianProcess, RepeatedCasesNeedNoNoise) {
  MatrixD x(3, 1);
  x << 0, 0, 1;
  const Eigen::MatrixXd y = Eigen::Vector3d(1, 1, 2);

  const GaussianProcess process(x, y, {Eigen::VectorXd::Ones(1), 1, 0, Covariance::gaussian});

  EXPECT_NEAR(process.mean(x)(0, 0), 1, 1e-4);
}

}  // namespace
}  // namespace elrom::math
