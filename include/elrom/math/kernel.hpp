#pragma once
// Stationary covariance functions of a scaled distance r, with k(0) = 1 (Rasmussen & Williams 2006,
// section 4.2).

#include <Eigen/Core>
#include <string>
#include <string_view>

#include "elrom/math/matrix.hpp"

namespace elrom::math {

enum class Covariance { exponential, matern32, matern52, gaussian };
[[nodiscard]] std::string_view name_of(Covariance covariance);
/// @throws InputError with the known names
[[nodiscard]] Covariance covariance_of(std::string_view name);

/// k(r); far cases give 0, never a NaN.
[[nodiscard]] double covariance(Covariance kind, double r);

/// Squared distances between the rows of a (n, p) and b (m, p): (n, m), never negative.
[[nodiscard]] Eigen::MatrixXd squared_distances(const MatrixD& a, const MatrixD& b);

/// Of all pairs of n cases, (n, n) each.
struct Covariances {
  Eigen::MatrixXd squares;  ///< r^2
  Eigen::MatrixXd k;        ///< covariance()
  /// (dk/dr) / r, finite at r = 0 for the differentiable ones (the exponential's is held at r = 1e-9).
  Eigen::MatrixXd slope;
};
/// With one exponential a pair, several pairs at a time. @param scaled inputs over their lengths, (n, p)
[[nodiscard]] Covariances covariances(Covariance kind, const MatrixD& scaled);

}  // namespace elrom::math
