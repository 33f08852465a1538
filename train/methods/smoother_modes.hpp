#pragma once
// The modes in which a smoother lets a field vary, and the process of each: the smoother has one noise for
// all that a field does, although its leading modes hardly are noise; internal to methods.
//
// A mode is a combination of cases, so a case's product with a mode holds the case's product with itself,
// its noise squared, which would pass for signal and make every mode look predictable. So that noise is taken
// from each case's product with itself: of what the others do not predict of the case, the share that by the
// smoother's own account is noise and not too few cases, noise P_ii (Rasmussen & Williams 2006, eq. 5.12).

#include <Eigen/Core>
#include <vector>

#include "elrom/math/matrix.hpp"
#include "elrom/model/smoother_coefficients.hpp"

namespace elrom::methods {

/// The smoother of one covariance on the training cases.
struct Smoother {
  Eigen::MatrixXd covariance, precision, inverse_factor;  //!< K, (K + noise I)^-1, L^-1

  /// @throws NumericalError when K + noise I is not positive definite
  Smoother(const model::SmootherKernel& kernel, const MatrixD& z);

  /// Rows predict each case from the others: I - diag(P)^-1 P.
  [[nodiscard]] Eigen::MatrixXd leave_one_out() const;
  /// The same of departures from the mean of the others: each of them loses that mean.
  [[nodiscard]] Eigen::MatrixXd leave_one_out_about_mean() const;
};

struct SmootherModes {
  Eigen::MatrixXd basis;    //!< modes = basis * cases, orthonormal, (n_modes, n_cases)
  Eigen::MatrixXd targets;  //!< coefficients of the cases without their own noise, (n_cases, n_modes)
  /// Of the leading modes, one each; the others have the smoother's.
  std::vector<model::SmootherKernel> own_kernels = {};

  /// Runs of neighbouring modes with one kernel, in order: calls take(kernel, first, n).
  template <class Take>
  void each_group(const model::SmootherKernel& common, const Take& take) const {
    const auto n_own = static_cast<Eigen::Index>(own_kernels.size());
    for (Eigen::Index m = 0; m < n_own; ++m) take(own_kernels[static_cast<std::size_t>(m)], m, 1);
    if (targets.cols() > n_own) take(common, n_own, targets.cols() - n_own);
  }
};

struct ModeLimits {
  std::size_t most = 80;  ///< modes
  std::size_t own = 8;    ///< of a symmetric part: leading modes with a kernel of their own
  double may_drop = 0;    ///< energy, summed over cases and cells, that the left-out modes may hold
};

/// @param gram products of the cases, about their mean if the kernel is symmetric, (n_cases, n_cases)
/// @return no modes where the smoother predicts nothing. One mode at least has the smoother's own kernel
[[nodiscard]] SmootherModes modes_of(const model::SmootherKernel& kernel, const MatrixD& z,
                                     const Eigen::MatrixXd& gram, const ModeLimits& limits, int n_threads);

}  // namespace elrom::methods
