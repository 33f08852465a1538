#include "elrom/math/ridge.hpp"

#include <limits>
#include <utility>

#include "elrom/base/error.hpp"
#include "elrom/math/linear_algebra.hpp"

namespace elrom::math {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Centred inputs x = T V^T with T^T T = diag(l): every penalty then costs only n * n_inputs * n_targets.
struct Problem {
  Eigen::RowVectorXd x_mean, y_mean;
  MatrixXd y_centred, t, v, tty;
  VectorXd l;

  Problem(const MatrixD& x, const MatrixXd& y, std::span<const double> penalties)
      : x_mean(x.colwise().mean()), y_mean(y.colwise().mean()), y_centred(y.rowwise() - y_mean) {
    check(!penalties.empty() && x.rows() == y.rows() && x.rows() > 0, "ridge: cases, targets and a penalty");
    const MatrixXd centred = x.rowwise() - x_mean;
    SymmetricEigen eigen = symmetric_eigen(centred.transpose() * centred);
    l = eigen.values.cwiseMax(0);
    v = std::move(eigen.vectors);
    t = centred * v;
    tty = t.transpose() * y_centred;
  }

  /// Of fits that left one case out each: (y - H y)_i / (1 - H_ii), H = 1/n + T (diag(l) + a)^-1 T^T.
  [[nodiscard]] MatrixXd residuals(double penalty) const {
    const VectorXd inverse = (l.array() + penalty).inverse();
    const MatrixXd residual = y_centred - t * (inverse.asDiagonal() * tty);
    const VectorXd leverage =
        (t.array().square().matrix() * inverse).array() + 1.0 / static_cast<double>(t.rows());
    return residual.array().colwise() / (1 - leverage.array()).cwiseMax(1e-12);
  }

  /// What follows from the penalty of each target and its residuals.
  void solve(const VectorXd& penalties, Ridge& ridge) const {
    ridge.loo_variance = ridge.loo_residuals.colwise().squaredNorm().transpose() /
                         static_cast<double>(ridge.loo_residuals.rows());
    MatrixXd scaled = tty;
    for (Eigen::Index k = 0; k < scaled.cols(); ++k) scaled.col(k).array() /= l.array() + penalties[k];
    ridge.weights = v * scaled;
    ridge.intercept = (y_mean - x_mean * ridge.weights).transpose();
  }
};

}  // namespace

MatrixXd Ridge::predict(const MatrixD& x) const { return (x * weights).rowwise() + intercept.transpose(); }

Ridge fit_ridge(const MatrixD& x, const MatrixXd& y, std::span<const double> penalties) {
  const Problem problem(x, y, penalties);
  Ridge ridge;
  double least = std::numeric_limits<double>::infinity();
  for (double penalty : penalties) {
    MatrixXd residuals = problem.residuals(penalty);
    const double squares = residuals.squaredNorm();
    if (squares < least || ridge.penalty == 0) {
      least = squares;
      ridge.penalty = penalty;
      ridge.loo_residuals = std::move(residuals);
    }
  }
  problem.solve(VectorXd::Constant(y.cols(), ridge.penalty), ridge);
  return ridge;
}

Ridge fit_ridge_each(const MatrixD& x, const MatrixXd& y, std::span<const double> penalties) {
  const Problem problem(x, y, penalties);
  Ridge ridge;
  ridge.loo_residuals = problem.residuals(penalties.front());
  VectorXd own = VectorXd::Constant(y.cols(), penalties.front());
  for (double penalty : penalties.subspan(1)) {
    const MatrixXd residuals = problem.residuals(penalty);
    for (Eigen::Index k = 0; k < y.cols(); ++k) {
      if (residuals.col(k).squaredNorm() >= ridge.loo_residuals.col(k).squaredNorm()) continue;
      own[k] = penalty;
      ridge.loo_residuals.col(k) = residuals.col(k);
    }
  }
  problem.solve(own, ridge);
  return ridge;
}

}  // namespace elrom::math
