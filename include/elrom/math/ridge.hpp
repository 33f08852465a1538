#pragma once
// Ridge regression with a free intercept; the penalty by leave-one-out in closed form (Allen's PRESS).

#include <Eigen/Core>
#include <span>

#include "elrom/math/matrix.hpp"

namespace elrom::math {

struct Ridge {
  MatrixD weights;                //!< (n_inputs, n_targets)
  Eigen::VectorXd intercept;      //!< (n_targets)
  double penalty = 0;             ///< alpha in |y - x w - b|^2 + alpha |w|^2
  Eigen::VectorXd loo_variance;   //!< mean squared leave-one-out residual, (n_targets)
  Eigen::MatrixXd loo_residuals;  //!< truth minus the prediction of a fit without that case, (n, n_targets)

  [[nodiscard]] Eigen::MatrixXd predict(const MatrixD& x) const;
};

/// Tries every penalty and keeps the one of the least leave-one-out error over all targets together.
/// @param x (n, n_inputs), standardised @param y (n, n_targets) @param penalties positive; one: no choice
[[nodiscard]] Ridge fit_ridge(const MatrixD& x, const Eigen::MatrixXd& y, std::span<const double> penalties);

/// The same with a penalty for each target, which `penalty` does not tell.
[[nodiscard]] Ridge fit_ridge_each(const MatrixD& x, const Eigen::MatrixXd& y,
                                   std::span<const double> penalties);

}  // namespace elrom::math
