#include "elrom/math/linear_algebra.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "elrom/base/random.hpp"

namespace elrom::math {
namespace {

using Eigen::MatrixXd;

// Large enough for Eigen's blocked ways.
MatrixXd random_positive(Eigen::Index n) {
  base::Random random(base::Seed(5).derive("linear algebra"));
  MatrixXd a(n, n);
  for (double& value : a.reshaped()) value = random.normal();
  return a * a.transpose() + MatrixXd::Identity(n, n);
}

// The upper triangle holds what nobody may read.
MatrixXd lower_only(const MatrixXd& matrix) {
  MatrixXd lower = MatrixXd::Constant(matrix.rows(), matrix.cols(), std::numeric_limits<double>::quiet_NaN());
  lower.triangularView<Eigen::Lower>() = matrix;
  return lower;
}

TEST(CentredProducts, AreThoseOfRowsLessTheirMean) {
  const MatrixXd rows = random_positive(7);
  const MatrixXd centred = rows.rowwise() - rows.colwise().mean();

  const MatrixXd products = centred_products(rows * rows.transpose());

  EXPECT_TRUE(products.isApprox(centred * centred.transpose(), 1e-12));
}

TEST(SymmetricEigen, KnowsATwoByTwoByHand) {
  const SymmetricEigen eigen = symmetric_eigen((MatrixXd(2, 2) << 2, 1, 1, 2).finished());

  ASSERT_TRUE(eigen.converged);
  EXPECT_NEAR(eigen.values[0], 1, 1e-14);
  EXPECT_NEAR(eigen.values[1], 3, 1e-14);
  EXPECT_NEAR(std::abs(eigen.vectors.col(0).dot(Eigen::Vector2d(1, -1))), std::sqrt(2), 1e-14);
  EXPECT_NEAR(std::abs(eigen.vectors.col(1).dot(Eigen::Vector2d(1, 1))), std::sqrt(2), 1e-14);
}

TEST(SymmetricEigen, VectorsAreOrthonormalAndGiveTheMatrixBack) {
  const MatrixXd a = random_positive(70);

  const SymmetricEigen eigen = symmetric_eigen(lower_only(a));

  const MatrixXd back = eigen.vectors * eigen.values.asDiagonal() * eigen.vectors.transpose();
  EXPECT_TRUE(back.isApprox(a, 1e-12));
  EXPECT_TRUE((eigen.vectors.transpose() * eigen.vectors).isIdentity(1e-12));
  for (Eigen::Index i = 1; i < a.rows(); ++i) EXPECT_LE(eigen.values[i - 1], eigen.values[i]);
}

TEST(SymmetricEigen, SaysWhenTheMatrixIsNotFinite) {
  MatrixXd a = random_positive(5);
  a(3, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(symmetric_eigen(a).converged);
}

TEST(LeastNormSolution, SolvesAnIndefiniteSystem) {
  const MatrixXd a = random_positive(30) - 20 * MatrixXd::Identity(30, 30),
                 x = random_positive(30).leftCols(2);

  EXPECT_TRUE(least_norm_solution(lower_only(a), a * x).isApprox(x, 1e-10));
}

TEST(LeastNormSolution, OfManySolutionsTheSmallest) {
  // x + y = 2 twice over, and x + y = 4 beside it: their mean, shared equally
  const MatrixXd ones = MatrixXd::Ones(2, 2);

  EXPECT_TRUE(least_norm_solution(ones, Eigen::Vector2d(2, 2)).isApprox(Eigen::Vector2d(1, 1), 1e-14));
  EXPECT_TRUE(least_norm_solution(ones, Eigen::Vector2d(2, 4)).isApprox(Eigen::Vector2d(1.5, 1.5), 1e-14));
}

TEST(Cholesky, KnowsATwoByTwoByHand) {
  // L = [2 0; 1 3]
  const Cholesky factor((MatrixXd(2, 2) << 4, 2, 2, 10).finished());

  ASSERT_TRUE(factor.succeeded());
  EXPECT_TRUE(
      factor.inverse_factor().isApprox((MatrixXd(2, 2) << 0.5, 0, -1.0 / 6, 1.0 / 3).finished(), 1e-14));
  EXPECT_TRUE(factor.inverse().isApprox((MatrixXd(2, 2) << 10, -2, -2, 4).finished() / 36, 1e-14));
  EXPECT_NEAR(factor.log_determinant(), std::log(36.0), 1e-14);
}

TEST(Cholesky, SolvesAndInverts) {
  const MatrixXd k = random_positive(150), right = random_positive(150).leftCols(3);

  const Cholesky factor(lower_only(k));

  ASSERT_TRUE(factor.succeeded());
  EXPECT_TRUE((k * factor.solve(right)).isApprox(right, 1e-11));
  EXPECT_TRUE((k * factor.inverse()).isIdentity(1e-9));
  EXPECT_TRUE((factor.inverse_factor() * k * factor.inverse_factor().transpose()).isIdentity(1e-9));
}

TEST(Cholesky, InvertsAnySize) {
  // One block, halves of unequal size, halves of halves.
  for (const Eigen::Index n : {1, 7, 24, 25, 40, 63, 113}) {
    const MatrixXd k = random_positive(n), identity = MatrixXd::Identity(n, n);
    const Cholesky factor(lower_only(k));

    EXPECT_TRUE(factor.inverse().isApprox(factor.solve(identity), 1e-11)) << n;
    EXPECT_EQ(factor.inverse(), factor.inverse().transpose()) << n;
    EXPECT_TRUE((factor.inverse_factor().transpose() * factor.inverse_factor())
                    .isApprox(factor.solve(identity), 1e-11))
        << n;
    EXPECT_TRUE(factor.inverse_factor().isLowerTriangular(0)) << n;
  }
}

TEST(Cholesky, RefusesWhatIsNotPositiveDefinite) {
  EXPECT_FALSE(Cholesky((MatrixXd(2, 2) << 1, 2, 2, 1).finished()).succeeded());
}

}  // namespace
}  // namespace elrom::math
