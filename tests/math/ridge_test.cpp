#include "elrom/math/ridge.hpp"

#include <gtest/gtest.h>

#include "elrom/base/random.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::math {
namespace {

struct LinearSample {
  MatrixD x{20, 4};
  Eigen::MatrixXd y{20, 2};
  LinearSample() {
    base::Random random(base::Seed(13).derive("ridge"));
    for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = random.normal();
    for (Eigen::Index i = 0; i < 20; ++i) y.row(i) << 5 + x(i, 0) + random.normal(), x(i, 1) - 2 * x(i, 2);
  }
};

TEST(Ridge, SolvesTheNormalEquations) {
  const LinearSample sample;
  const std::vector<double> penalty{3.0};

  const Ridge ridge = fit_ridge(sample.x, sample.y, penalty);

  const Eigen::MatrixXd x = sample.x.rowwise() - sample.x.colwise().mean();
  const Eigen::MatrixXd y = sample.y.rowwise() - sample.y.colwise().mean();
  const Eigen::MatrixXd normal = x.transpose() * x + 3 * Eigen::MatrixXd::Identity(4, 4);
  EXPECT_TRUE((normal * ridge.weights).isApprox(x.transpose() * y, 1e-10)) << ridge.weights;
}

TEST(Ridge, LeaveOneOutVarianceEqualsRefits) {
  const LinearSample sample;
  const std::vector<double> penalty{0.7};
  const Ridge ridge = fit_ridge(sample.x, sample.y, penalty);
  Eigen::RowVector2d squares = Eigen::RowVector2d::Zero();

  for (std::size_t left = 0; left < 20; ++left) {
    std::vector<std::size_t> rest = all_rows(20);
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(left));
    const auto i = static_cast<Eigen::Index>(left);
    const Ridge refit = fit_ridge(take_rows(sample.x, rest), take_rows(MatrixD(sample.y), rest), penalty);
    const MatrixD own = sample.x.row(i);
    squares += (sample.y.row(i) - refit.predict(own)).cwiseAbs2();
  }

  EXPECT_TRUE(ridge.loo_variance.transpose().isApprox(squares / 20, 1e-10))
      << ridge.loo_variance.transpose() << "\n"
      << squares / 20;
}

TEST(Ridge, PrefersTheSmallPenaltyOnExactData) {
  const LinearSample sample;
  const Eigen::MatrixXd exact = sample.x.col(1) - 2 * sample.x.col(2);
  const std::vector<double> penalties{100, 1e-6, 1};

  EXPECT_EQ(fit_ridge(sample.x, exact, penalties).penalty, 1e-6);
}

TEST(Ridge, EqualInputsShareTheirWeight) {
  MatrixD x(3, 2);
  x << -1, -1, 0, 0, 1, 1;
  const std::vector<double> penalties{1e-8};

  const Ridge ridge = fit_ridge(x, Eigen::Vector3d(-2, 0, 2), penalties);

  EXPECT_NEAR(ridge.weights(0, 0), 1, 1e-6);
  EXPECT_NEAR(ridge.weights(1, 0), 1, 1e-6);
}

TEST(Ridge, APenaltyEachIsThatOfATargetAlone) {
  base::Random random(base::Seed(7));
  const MatrixD x = MatrixD::NullaryExpr(20, 3, [&] { return random.normal(); });
  Eigen::MatrixXd y = Eigen::MatrixXd::NullaryExpr(20, 2, [&] { return random.normal(); });
  y.col(0) = 3 * x.col(1);  // nothing to smooth, beside pure noise
  const std::vector<double> penalties{1e-4, 1, 1e4};

  const Ridge both = fit_ridge_each(x, y, penalties);

  for (Eigen::Index k = 0; k < 2; ++k) {
    const Ridge alone = fit_ridge(x, y.col(k), penalties);
    EXPECT_EQ(alone.penalty, k == 0 ? 1e-4 : 1e4);
    EXPECT_TRUE(both.weights.col(k).isApprox(alone.weights.col(0), 1e-12));
    EXPECT_NEAR(both.loo_variance[k], alone.loo_variance[0], 1e-12);
    EXPECT_NEAR(both.intercept[k], alone.intercept[0], 1e-12);
  }
}

}  // namespace
}  // namespace elrom::math
