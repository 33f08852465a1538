#include "elrom/math/gaussian_process.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "elrom/base/error.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/optimise.hpp"

namespace elrom::math {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

MatrixD divided(const MatrixD& inputs, const VectorXd& lengths) {
  return inputs.array().rowwise() / lengths.transpose().array();
}

/// Cholesky with the least jitter (relative to the diagonal, powers of 100) that succeeds.
Cholesky factorise(MatrixXd k) {
  const double diagonal = k.diagonal().mean();
  double added = 0;
  for (double jitter = 1e-12; jitter < 1e-3; jitter *= 100) {
    k.diagonal().array() += jitter * diagonal - added;
    added = jitter * diagonal;
    Cholesky factor(k);
    if (factor.succeeded()) return factor;
  }
  throw NumericalError("Gaussian process: the covariance matrix is not positive definite even with jitter");
}

GpParameters parameters_of(const VectorXd& theta, Covariance kind) {
  const Eigen::Index p = theta.size() - 2;
  return {theta.head(p).array().exp(), std::exp(theta[p]), std::exp(theta[p + 1]), kind};
}

}  // namespace

double gp_negative_log_likelihood(const MatrixD& inputs, const MatrixXd& targets, Covariance kind,
                                  const VectorXd& theta, VectorXd& gradient) {
  const Eigen::Index n = inputs.rows(), p = inputs.cols();
  const double n_targets = static_cast<double>(targets.cols());
  const GpParameters parameters = parameters_of(theta, kind);
  const MatrixD scaled = divided(inputs, parameters.length_scales);
  const Covariances c = covariances(kind, scaled);
  MatrixXd k = parameters.signal_variance * c.k;
  k.diagonal().array() += parameters.noise_variance;
  const Cholesky factor(k);
  gradient.setZero(theta.size());
  if (!factor.succeeded()) return std::numeric_limits<double>::infinity();

  const MatrixXd inverse = factor.inverse();
  const MatrixXd alpha = inverse * targets;
  const double log_det = factor.log_determinant();
  const double value = 0.5 * targets.cwiseProduct(alpha).sum() +
                       0.5 * n_targets * (log_det + static_cast<double>(n) * std::log(2 * std::numbers::pi));

  // Eq. 5.9 with W = sum over targets of K^-1 - alpha alpha^T: dJ/dtheta = tr(W dK/dtheta) / 2.
  const MatrixXd w = n_targets * inverse - alpha * alpha.transpose();
  // dK_ij / dlog l_k = -signal * slope_ij * (a_ik - a_jk)^2; the sum over i, j of a symmetric Q times that
  // square is 2 sum_i rowsum_i a_ik^2 - 2 a_k^T Q a_k.
  const MatrixXd q = -parameters.signal_variance * w.cwiseProduct(c.slope);
  const VectorXd row_sums = q.rowwise().sum();
  const MatrixD qa = q * scaled;
  for (Eigen::Index j = 0; j < p; ++j) {
    gradient[j] = row_sums.dot(scaled.col(j).cwiseAbs2()) - scaled.col(j).dot(qa.col(j));
  }
  gradient[p] = 0.5 * parameters.signal_variance * w.cwiseProduct(c.k).sum();
  gradient[p + 1] = 0.5 * parameters.noise_variance * w.trace();
  const double data = static_cast<double>(n) * n_targets;
  gradient /= data;
  return value / data;
}

GpParameters fit_gp(const MatrixD& inputs, const MatrixXd& targets, const GpFitOptions& options) {
  check(!options.start_noises.empty(), "Gaussian process: at least one noise to start from");
  const Eigen::Index p = inputs.cols(), n_lengths = options.isotropic ? 1 : p;
  VectorXd lower(n_lengths + 2), upper(n_lengths + 2), start(n_lengths + 2), all(p + 2), slopes;
  lower << VectorXd::Constant(n_lengths, std::log(options.lowest_length)), std::log(options.lowest_signal),
      std::log(options.lowest_noise);
  upper << VectorXd::Constant(n_lengths, std::log(options.highest_length)), std::log(options.highest_signal),
      std::log(options.highest_noise);
  const auto spread = [&](const VectorXd& theta) -> const VectorXd& {
    for (Eigen::Index j = 0; j < p; ++j) all[j] = theta[std::min(j, n_lengths - 1)];
    all.tail(2) = theta.tail(2);
    return all;
  };
  const Objective objective = [&](const VectorXd& theta, VectorXd& gradient) {
    const double value =
        gp_negative_log_likelihood(inputs, targets, options.covariance, spread(theta), slopes);
    gradient.resize(theta.size());
    if (options.isotropic)
      gradient[0] = slopes.head(p).sum();
    else
      gradient.head(p) = slopes.head(p);
    gradient.tail(2) = slopes.tail(2);
    return value;
  };
  Minimum best{{}, std::numeric_limits<double>::infinity(), 0};
  for (std::size_t i = 0; i < options.start_lengths.size(); ++i) {
    const double noise = options.start_noises[i % options.start_noises.size()];
    start << VectorXd::Constant(n_lengths, std::log(options.start_lengths[i])), 0, std::log(noise);
    const Minimum found =
        minimise(objective, start, lower, upper, {.max_iterations = options.max_iterations});
    if (found.value < best.value) best = found;
  }
  check(best.x.size() == n_lengths + 2, "Gaussian process: at least one start");
  return parameters_of(spread(best.x), options.covariance);
}

GaussianProcess::GaussianProcess(const MatrixD& inputs, const MatrixXd& targets, GpParameters parameters)
    : parameters_(std::move(parameters)), scaled_inputs_(divided(inputs, parameters_.length_scales)) {
  MatrixXd k = parameters_.signal_variance * covariances(parameters_.covariance, scaled_inputs_).k;
  k.diagonal().array() += parameters_.noise_variance;
  const Cholesky factor = factorise(std::move(k));
  weights_ = factor.solve(targets);
  inverse_factor_ = factor.inverse_factor();
}

MatrixXd GaussianProcess::cross_covariance(const MatrixD& x) const {
  const MatrixXd r = squared_distances(divided(x, parameters_.length_scales), scaled_inputs_).cwiseSqrt();
  return parameters_.signal_variance *
         r.unaryExpr([&](double d) { return covariance(parameters_.covariance, d); });
}

MatrixXd GaussianProcess::mean(const MatrixD& x) const { return cross_covariance(x) * weights_; }

VectorXd GaussianProcess::variance(const MatrixD& x) const {
  const MatrixXd whitened = inverse_factor_ * cross_covariance(x).transpose();
  return (parameters_.signal_variance - whitened.colwise().squaredNorm().transpose().array()).cwiseMax(0);
}

MatrixXd GaussianProcess::leave_one_out_residuals() const {
  const VectorXd precision = inverse_factor_.colwise().squaredNorm().transpose();  // diagonal of K^-1
  return weights_.array().colwise() / precision.array();
}

}  // namespace elrom::math
