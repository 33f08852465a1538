#pragma once
// What the magnitude of a field follows: powers of the quantities that its inputs say, such as a pressure
// that grows as the solids' inventory. A field over its scale varies less from case to case, and so does its
// noise. Internal to methods.

#include <Eigen/Core>

#include "elrom/math/matrix.hpp"

namespace elrom::methods {

/// What a smoother leaves of cases that are not centred, each left out: their departures from the mean of the
/// others, less what is predicted of these. Rows add up to 0. @param leave_one_out_about_mean of the smoother
[[nodiscard]] Eigen::MatrixXd residual_operation(const Eigen::MatrixXd& leave_one_out_about_mean);

/// Squared error of each case s_i (R diag(s)^-1 y)_i over all cells, where fields over their scales are
/// smoothed: s_i^2 (B G B^T)_ii with B = R diag(s)^-1.
/// @param residual R, (n_cases, n_cases) @param gram G = Y Y^T, not centred @param scales s, (n_cases)
[[nodiscard]] Eigen::VectorXd scaled_errors(const Eigen::MatrixXd& residual, const Eigen::MatrixXd& gram,
                                            const Eigen::VectorXd& scales);

/// Exponents a of s_i = exp(logs_i . a) with the least sum of scaled_errors(), held near 0 as far as the
/// cases say little. @param logs of the quantities, (n_cases, n_quantities) @param start (n_quantities)
[[nodiscard]] Eigen::VectorXd fit_exponents(const Eigen::MatrixXd& residual, const Eigen::MatrixXd& gram,
                                            const MatrixD& logs, const Eigen::VectorXd& start);

}  // namespace elrom::methods
