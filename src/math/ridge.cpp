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

}  // namespace

MatrixXd Ridge::predict(const MatrixD& x) const { return (x * weights).rowwise() + intercept.transpose(); }

Ridge fit_ridge(const MatrixD& x, const MatrixXd& y, std::span<const double> penalties) {
  check(!penalties.empty() && x.rows() == y.rows() && x.rows() > 0, "ridge: cases, targets and a penalty");
  const Eigen::RowVectorXd x_mean = x.colwise().mean(), y_mean = y.colwise().mean();
  const MatrixXd x_centred = x.rowwise() - x_mean, y_centred = y.rowwise() - y_mean;
  const Eigen::JacobiSVD<MatrixXd> svd(x_centred, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Decomposition d{svd.matrixU(), svd.matrixV(), svd.singularValues()};
  const MatrixXd uty = d.u.transpose() * y_centred;

  Ridge ridge;
  double least = std::numeric_limits<double>::infinity();
  for (double penalty : penalties) {
    MatrixXd residuals = loo_residuals(d, y_centred, uty, penalty);
    const double squares = residuals.squaredNorm();
    if (squares < least || ridge.penalty == 0) {
      least = squares;
      ridge.penalty = penalty;
      ridge.loo_residuals = std::move(residuals);
    }
  }
  ridge.loo_variance =
      ridge.loo_residuals.colwise().squaredNorm().transpose() / static_cast<double>(x.rows());
  const VectorXd inverse = d.s.array() / (d.s.array().square() + ridge.penalty);
  ridge.weights = d.v * (inverse.asDiagonal() * uty);
  ridge.intercept = (y_mean - x_mean * ridge.weights).transpose();
  return ridge;
}

}  // namespace elrom::math
