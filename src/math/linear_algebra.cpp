#include "elrom/math/linear_algebra.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <limits>

namespace elrom::math {

using Eigen::MatrixXd;

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

MatrixXd Cholesky::inverse() const { return solve(MatrixXd::Identity(lower_.rows(), lower_.cols())); }

MatrixXd Cholesky::inverse_factor() const {
  return lower_.triangularView<Eigen::Lower>().solve(MatrixXd::Identity(lower_.rows(), lower_.cols()));
}

MatrixXd Cholesky::solve(const MatrixXd& right) const {
  MatrixXd solution = right;
  lower_.triangularView<Eigen::Lower>().solveInPlace(solution);
  lower_.triangularView<Eigen::Lower>().adjoint().solveInPlace(solution);
  return solution;
}

double Cholesky::log_determinant() const { return 2 * lower_.diagonal().array().log().sum(); }

}  // namespace elrom::math
