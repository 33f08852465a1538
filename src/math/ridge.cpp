#include "elrom/math/ridge.hpp"

#include <Eigen/SVD>
#include <limits>

#include "elrom/base/error.hpp"

namespace elrom::math {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// x = U S V^T of the centred inputs: every penalty then costs only n * rank * n_targets.
struct Decomposition {
  MatrixXd u, v;
  VectorXd s;
};

/// Residuals of fits that left one case out each: (y - H y)_i / (1 - H_ii), H = 1/n + U S^2/(S^2+a) U^T.
MatrixXd loo_residuals(const Decomposition& d, const MatrixXd& y_centred, const MatrixXd& uty,
                       double penalty) {
  const VectorXd shrink = d.s.array().square() / (d.s.array().square() + penalty);
  const MatrixXd residual = y_centred - d.u * (shrink.asDiagonal() * uty);
  const VectorXd leverage =
      (d.u.array().square().matrix() * shrink).array() + 1.0 / static_cast<double>(y_centred.rows());
  return residual.array().colwise() / (1 - leverage.array()).cwiseMax(1e-12);
}

/// Centred inputs, decomposed, and centred targets.
struct Problem {
  Eigen::RowVectorXd x_mean, y_mean;
  MatrixXd y_centred, uty;
  Decomposition d;

  Problem(const MatrixD& x, const MatrixXd& y, std::span<const double> penalties)
      : x_mean(x.colwise().mean()), y_mean(y.colwise().mean()), y_centred(y.rowwise() - y_mean) {
    check(!penalties.empty() && x.rows() == y.rows() && x.rows() > 0, "ridge: cases, targets and a penalty");
    const Eigen::JacobiSVD<MatrixXd> svd(MatrixXd(x.rowwise() - x_mean),
                                         Eigen::ComputeThinU | Eigen::ComputeThinV);
    d = {svd.matrixU(), svd.matrixV(), svd.singularValues()};
    uty = d.u.transpose() * y_centred;
  }

  [[nodiscard]] MatrixXd residuals(double penalty) const { return loo_residuals(d, y_centred, uty, penalty); }

  /// What follows from the penalty of each target and its residuals.
  void solve(const VectorXd& penalties, Ridge& ridge) const {
    ridge.loo_variance = ridge.loo_residuals.colwise().squaredNorm().transpose() /
                         static_cast<double>(ridge.loo_residuals.rows());
    MatrixXd scaled = uty;
    for (Eigen::Index k = 0; k < scaled.cols(); ++k)
      scaled.col(k).array() *= d.s.array() / (d.s.array().square() + penalties[k]);
    ridge.weights = d.v * scaled;
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
