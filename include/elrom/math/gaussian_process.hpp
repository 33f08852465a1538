#pragma once
// Gaussian-process regression with one covariance function shared by all targets (Rasmussen & Williams 2006,
// chapters 2 and 5): a length scale for every input (ARD), signal and noise variance.
//
// Non-goals: standardisation (callers give inputs and targets of
// unit size and zero mean), sparse approximations.

#include <Eigen/Core>
#include <vector>

#include "elrom/math/kernel.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::math {

struct GpParameters {
  Eigen::VectorXd length_scales;  //!< (n_inputs), in units of the standardised inputs
  double signal_variance = 1;
  double noise_variance = 0.1;
  Covariance covariance = Covariance::matern52;
};

/// Box of the search and its starts, for inputs and targets of unit variance.
struct GpFitOptions {
  Covariance covariance = Covariance::matern52;
  bool isotropic = false;                       ///< one length scale for all inputs
  std::vector<double> start_lengths{5.0, 2.0};  ///< one search from each; the best likelihood wins
  std::vector<double> start_noises{
      0.1};  ///< their noise variances; with fewer than starts, from the first again
  double lowest_length = 0.3, highest_length = 1e3;
  /// Far above the targets' variance: of a smooth function only a piece of one wave is seen.
  double lowest_signal = 1e-3, highest_signal = 1e5;
  double lowest_noise = 1e-8, highest_noise = 3;
  int max_iterations = 100;
};

/// Negative log marginal likelihood per datum (n_cases * n_targets), eq. 2.30, and its gradient (eq. 5.9)
/// with respect to theta = (log length scales, log signal variance, log noise variance).
/// @param inputs (n_cases, n_inputs) @param targets (n_cases, n_targets)
[[nodiscard]] double gp_negative_log_likelihood(const MatrixD& inputs, const Eigen::MatrixXd& targets,
                                                Covariance covariance, const Eigen::VectorXd& theta,
                                                Eigen::VectorXd& gradient);

/// Parameters of the largest marginal likelihood. Deterministic.
[[nodiscard]] GpParameters fit_gp(const MatrixD& inputs, const Eigen::MatrixXd& targets,
                                  const GpFitOptions& options = {});

/// Thread rule: const use from any thread.
class GaussianProcess {
 public:
  GaussianProcess() = default;
  /// Adds as little jitter as a Cholesky factorisation needs. @throws NumericalError when no jitter helps
  GaussianProcess(const MatrixD& inputs, const Eigen::MatrixXd& targets, GpParameters parameters);

  [[nodiscard]] const GpParameters& parameters() const { return parameters_; }
  /// K^-1 targets, (n_cases, n_targets).
  [[nodiscard]] const Eigen::MatrixXd& weights() const { return weights_; }
  /// L^-1 of K = L L^T, lower triangular, (n_cases, n_cases): variance(x) = k(x, x) - |L^-1 k(x)|^2.
  [[nodiscard]] const Eigen::MatrixXd& inverse_factor() const { return inverse_factor_; }

  /// Posterior mean at the rows of x: (n, n_targets).
  [[nodiscard]] Eigen::MatrixXd mean(const MatrixD& x) const;
  /// Posterior variance of the noise-free function, in units of the targets squared, (n).
  [[nodiscard]] Eigen::VectorXd variance(const MatrixD& x) const;
  /// Truth minus the prediction of a process that did not see that case, closed form (eqs. 5.10, 5.11),
  /// (n_cases, n_targets).
  [[nodiscard]] Eigen::MatrixXd leave_one_out_residuals() const;

 private:
  [[nodiscard]] Eigen::MatrixXd cross_covariance(const MatrixD& x) const;  // (n, n_cases)

  GpParameters parameters_;
  MatrixD scaled_inputs_;  //!< inputs / length scales
  Eigen::MatrixXd weights_, inverse_factor_;
};

}  // namespace elrom::math
