#include "elrom/math/linear_algebra.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>

namespace elrom::math {

using Eigen::MatrixXd;

namespace {

using Block = Eigen::Ref<MatrixXd>;

/// Where halving ends. Halves are multiples of 8, as vectors are.
constexpr Eigen::Index smallest_halved = 24;
Eigen::Index half_of(Eigen::Index n) { return (n / 2 + 7) / 8 * 8; }

/// L to L^-1 in place, with a third of the products that solving for the identity takes; the upper triangle
/// is not touched.
void invert_lower(Block l) {
  const auto n = l.rows();
  if (n <= smallest_halved) {
    const MatrixXd inverse = l.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(n, n));
    l.triangularView<Eigen::Lower>() = inverse;
    return;
  }
  const auto h = half_of(n);
  auto a = l.topLeftCorner(h, h), b = l.bottomLeftCorner(n - h, h), c = l.bottomRightCorner(n - h, n - h);
  invert_lower(a);
  invert_lower(c);
  const MatrixXd ba = b * a.triangularView<Eigen::Lower>();
  b.noalias() = -(c.triangularView<Eigen::Lower>() * ba);
}

/// L to the lower triangle of L^T L, in place.
void multiply_by_own_transpose(Block l) {
  const auto n = l.rows();
  if (n <= smallest_halved) {
    const MatrixXd lower = l.triangularView<Eigen::Lower>();
    l.triangularView<Eigen::Lower>() = lower.transpose() * lower;
    return;
  }
  const auto h = half_of(n);
  auto a = l.topLeftCorner(h, h), b = l.bottomLeftCorner(n - h, h), c = l.bottomRightCorner(n - h, n - h);
  multiply_by_own_transpose(a);
  a.selfadjointView<Eigen::Lower>().rankUpdate(b.transpose());
  const MatrixXd cb = c.triangularView<Eigen::Lower>().adjoint() * b;
  b = cb;
  multiply_by_own_transpose(c);
}

}  // namespace

SymmetricEigen symmetric_eigen(const MatrixXd& matrix) {
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(matrix);
  return {solver.eigenvalues(), solver.eigenvectors(), solver.info() == Eigen::Success};
}

MatrixXd centred_products(MatrixXd gram) {
  gram.rowwise() -= gram.colwise().mean().eval();
  gram.colwise() -= gram.rowwise().mean().eval();
  return gram;
}

MatrixXd least_norm_solution(const MatrixXd& matrix, const MatrixXd& right) {
  const SymmetricEigen eigen = symmetric_eigen(matrix);
  const double zero = static_cast<double>(matrix.rows()) * std::numeric_limits<double>::epsilon() *
                      eigen.values.cwiseAbs().maxCoeff();
  const Eigen::VectorXd inverse =
      (eigen.values.array().abs() > zero).select(eigen.values.array().inverse(), 0);
  return eigen.vectors * (inverse.asDiagonal() * (eigen.vectors.transpose() * right));
}

Cholesky::Cholesky(const MatrixXd& matrix) : lower_(matrix) {
  const Eigen::LLT<Eigen::Ref<MatrixXd>> factor(lower_);  // in place
  succeeded_ = factor.info() == Eigen::Success;
}

MatrixXd Cholesky::inverse() const {
  MatrixXd inverse = lower_;
  invert_lower(inverse);
  multiply_by_own_transpose(inverse);
  inverse.triangularView<Eigen::StrictlyUpper>() = inverse.transpose();
  return inverse;
}

MatrixXd Cholesky::inverse_factor() const {
  MatrixXd inverse = lower_.triangularView<Eigen::Lower>();
  invert_lower(inverse);
  return inverse;
}

MatrixXd Cholesky::solve(const MatrixXd& right) const {
  MatrixXd solution = right;
  lower_.triangularView<Eigen::Lower>().solveInPlace(solution);
  lower_.triangularView<Eigen::Lower>().adjoint().solveInPlace(solution);
  return solution;
}

double Cholesky::log_determinant() const { return 2 * lower_.diagonal().array().log().sum(); }

}  // namespace elrom::math
