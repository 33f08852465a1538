#include "leave_one_out.hpp"

#include <cmath>
#include <limits>

#include "elrom/math/kernel.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/optimise.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Prior variance of the field's mean, in units of the signal: large, so that the data fix the mean.
constexpr double mean_variance = 100;

/// d J / d log(length) of each input, from q = dJ/dK * (dk/dr) / r. @param a inputs over their lengths
VectorXd length_slopes(const MatrixXd& q, const MatrixD& a) {
  const VectorXd row_sums = q.rowwise().sum();
  const MatrixD qa = q * a;
  VectorXd slopes(a.cols());
  for (Index j = 0; j < a.cols(); ++j)
    slopes[j] = -2 * (row_sums.dot(a.col(j).cwiseAbs2()) - a.col(j).dot(qa.col(j)));
  return slopes;
}

MatrixD columns(const MatrixD& z, const std::vector<Index>& used) {
  MatrixD taken(z.rows(), static_cast<Index>(used.size()));
  for (std::size_t j = 0; j < used.size(); ++j) taken.col(static_cast<Index>(j)) = z.col(used[j]);
  return taken;
}

/// theta = (log lengths, log linear, log noise)
/// @param criterion(covariance, noise, &slope): a value and its derivative by the covariance
template <class Criterion>
double symmetric_objective(const MatrixD& x, math::Covariance kind, const Criterion& criterion,
                           const VectorXd& theta, VectorXd& gradient) {
  const Index p = x.cols();
  const VectorXd inverse = (-theta.head(p)).array().exp();
  const double linear = std::exp(theta[p]), noise = std::exp(theta[p + 1]);
  const MatrixD a = x * inverse.asDiagonal();
  const auto m = math::covariances(kind, a);
  const MatrixXd dots = a * a.transpose();
  MatrixXd slope;
  const MatrixXd k = (m.k + linear * dots).array() + mean_variance;
  const double value = criterion(k, noise, &slope);

  gradient.setZero(theta.size());
  if (!std::isfinite(value)) return value;
  const MatrixD sa = slope * a;
  gradient.head(p) = length_slopes(slope.cwiseProduct(m.slope), a);
  for (Index j = 0; j < p; ++j) gradient[j] -= 2 * linear * sa.col(j).dot(a.col(j));
  gradient[p] = linear * slope.cwiseProduct(dots).sum();
  gradient[p + 1] = noise * slope.trace();
  return value;
}

/// theta = (log weights of the imbalances, log linear, log common length factor, log noise)
/// @param o imbalances, and a column of ones for a lasting asymmetry
double antisymmetric_objective(const MatrixD& a, const MatrixD& o, const MatrixXd& gram,
                               math::Covariance kind, const VectorXd& theta, VectorXd& gradient) {
  const Index p = o.cols();
  const VectorXd weights = theta.head(p).array().exp();
  const double linear = std::exp(theta[p]), noise = std::exp(theta[p + 2]);
  const auto m = math::covariances(kind, a * std::exp(-theta[p + 1]));
  const MatrixXd products = o * weights.asDiagonal() * o.transpose();
  const MatrixXd near = m.k.array() + linear;
  MatrixXd slope;
  const double value = leave_one_out_error(products.cwiseProduct(near), noise, gram, &slope);

  gradient.setZero(theta.size());
  if (!std::isfinite(value)) return value;
  const MatrixXd q = slope.cwiseProduct(near);
  gradient.head(p) = (q * o).cwiseProduct(o).colwise().sum().transpose().cwiseProduct(weights);
  const MatrixXd sp = slope.cwiseProduct(products);
  gradient[p] = linear * sp.sum();
  gradient[p + 1] = -sp.cwiseProduct(m.slope).cwiseProduct(m.squares).sum();
  gradient[p + 2] = noise * slope.trace();
  return value;
}

/// theta = (log lengths or log common length, log noise)
double stationary_objective(const MatrixD& x, const MatrixXd& gram, math::Covariance kind,
                            const VectorXd& theta, VectorXd& gradient) {
  const Index n = theta.size() - 1;
  const double noise = std::exp(theta[n]);
  MatrixD a = x;
  for (Index j = 0; j < x.cols(); ++j) a.col(j) *= std::exp(-theta[std::min(j, n - 1)]);
  const auto m = math::covariances(kind, a);
  MatrixXd slope;
  const double value = leave_one_out_error(m.k, noise, gram, &slope);

  gradient.setZero(theta.size());
  if (!std::isfinite(value)) return value;
  const VectorXd slopes = length_slopes(slope.cwiseProduct(m.slope), a);
  for (Index j = 0; j < x.cols(); ++j) gradient[std::min(j, n - 1)] += slopes[j];
  gradient[n] = noise * slope.trace();
  return value;
}

/// The objective's logarithm, so that tolerances mean the same for every field, however well it is predicted.
template <class F>
math::Objective logarithm(const F& objective) {
  return [&objective](const VectorXd& theta, VectorXd& gradient) {
    const double value = objective(theta, gradient) + std::numeric_limits<double>::min();
    gradient /= value;
    return std::log(value);
  };
}

struct Bounds {
  VectorXd lower, upper;
};

VectorXd logs(Index n, double repeated, std::initializer_list<double> rest) {
  VectorXd values(n + static_cast<Index>(rest.size()));
  values.head(n).setConstant(std::log(repeated));
  for (Index i = 0; double v : rest) values[n + i++] = std::log(v);
  return values;
}

/// Of a peer: to the end, as the authors of processes' programs go.
constexpr math::MinimiseOptions search_to_the_end{
    .max_iterations = 80, .memory = 10, .gradient_tolerance = 1e-6};
/// What the kernel's lengths and noise gain by smaller steps is far below what the cases can tell.
constexpr math::MinimiseOptions search{
    .max_iterations = 80, .memory = 10, .gradient_tolerance = 1e-6, .value_tolerance = 1e-6};
/// From a kernel of nearly the same cases: what more steps would gain is far below the scatter of the cases.
constexpr math::MinimiseOptions search_nearby{
    .max_iterations = 15, .memory = 10, .gradient_tolerance = 1e-5, .value_tolerance = 1e-6};

/// The least of what searches from each of `starts` find: a smooth field's error has several valleys.
math::Minimum least(const math::Objective& objective, std::span<const VectorXd> starts, const Bounds& bounds,
                    const math::MinimiseOptions& options) {
  math::Minimum best{{}, std::numeric_limits<double>::infinity(), 0};
  for (const VectorXd& start : starts) {
    math::Minimum found = math::minimise(objective, start, bounds.lower, bounds.upper, options);
    if (found.value < best.value || best.x.size() == 0) best = std::move(found);
  }
  return best;
}

VectorXd symmetric_start(const model::SmootherKernel& near, const std::vector<Index>& used) {
  VectorXd theta(static_cast<Index>(used.size()) + 2);
  theta << -near.inverse_lengths(used).array().log(), std::log(near.linear), std::log(near.noise);
  return theta;
}

model::SmootherKernel symmetric_kernel(const VectorXd& theta, const std::vector<Index>& used,
                                       Index n_features, math::Covariance covariance) {
  const auto p = static_cast<Index>(used.size());
  model::SmootherKernel kernel{.covariance = covariance,
                               .linear = std::exp(theta[p]),
                               .constant = mean_variance,
                               .noise = std::exp(theta[p + 1])};
  kernel.inverse_lengths = kernel.imbalance = VectorXd::Zero(n_features);
  kernel.inverse_lengths(used) = (-theta.head(p)).array().exp();
  return kernel;
}

Bounds symmetric_bounds(Index n_lengths) {
  return {logs(n_lengths, 0.5, {1e-3, 1e-8}), logs(n_lengths, 200, {30, 100})};
}

/// Negative log likelihood of one mode, its signal the best one, without constants.
double mode_likelihood(const MatrixXd& covariance, double noise, const VectorXd& y, MatrixXd* slope) {
  const auto n = static_cast<double>(y.size());
  MatrixXd k = covariance;
  k.diagonal().array() += noise;
  const math::Cholesky factor(k);
  if (!factor.succeeded()) return std::numeric_limits<double>::infinity();
  const MatrixXd inverse = factor.inverse();
  const VectorXd alpha = inverse * y;
  const double squares = y.dot(alpha);
  *slope = 0.5 * inverse - (0.5 * n / squares) * alpha * alpha.transpose();
  return 0.5 * n * std::log(squares) + 0.5 * factor.log_determinant();
}

/// Standard deviations of what modes depart by from their field, of the logarithms of lengths and noise.
constexpr double length_departure = 0.3, noise_departure = 1;

/// Weight of an imbalance, or of the asymmetry that lasts, beside m(r) = 1.
constexpr double usual_weight = 0.1, least_weight = 1e-5, most_weight = 10;

VectorXd antisymmetric_start(const model::SmootherKernel& near, const model::SmootherKernel& symmetric,
                             const Asymmetry& from) {
  double factor = 0, n = 0;
  for (Index j = 0; j < near.inverse_lengths.size(); ++j) {
    if (!(near.inverse_lengths[j] > 0 && symmetric.inverse_lengths[j] > 0)) continue;
    factor += std::log(symmetric.inverse_lengths[j] / near.inverse_lengths[j]);
    ++n;
  }
  VectorXd weights(static_cast<Index>(from.imbalances.size()) + (from.lasting ? 1 : 0));
  weights.head(static_cast<Index>(from.imbalances.size())) = near.imbalance(from.imbalances).cwiseAbs2();
  if (from.lasting) weights.tail<1>()[0] = near.constant > 0 ? near.constant : usual_weight;
  VectorXd theta(weights.size() + 3);
  theta << weights.array().log(), std::log(near.linear), factor / std::max(n, 1.0), std::log(near.noise);
  return theta;
}

}  // namespace

double leave_one_out_error(const MatrixXd& covariance, double noise, const MatrixXd& gram, MatrixXd* slope) {
  MatrixXd k = covariance;
  k.diagonal().array() += noise;
  const math::Cholesky factor(k);
  if (!factor.succeeded()) return std::numeric_limits<double>::infinity();
  const MatrixXd p = factor.inverse();
  const MatrixXd pg = p * gram;
  const VectorXd squares = pg.cwiseProduct(p).rowwise().sum();  // diagonal of P G P
  const VectorXd weight = p.diagonal().array().square().inverse();
  if (slope != nullptr) {
    // From dP = -P dK P: dJ/dK = P (2 C - G P W - W P G) P, C = diag(squares_i / P_ii^3), W = diag(weight).
    MatrixXd inner = -(weight.asDiagonal() * pg);
    inner += inner.transpose().eval();
    inner.diagonal().array() += 2 * squares.array() * weight.array() / p.diagonal().array();
    slope->resize(p.rows(), p.cols());
    slope->triangularView<Eigen::Lower>() = MatrixXd(p * inner) * p;
    slope->triangularView<Eigen::StrictlyUpper>() = slope->transpose();
  }
  return squares.dot(weight);
}

double significance(const VectorXd& gains) {
  math::RunningMoments moments;
  for (const double gain : gains) moments.add(gain);
  if (moments.mean() == 0) return 0;
  return moments.mean() / (moments.deviation() / std::sqrt(static_cast<double>(gains.size())));
}

StationaryKernel fit_stationary_kernel(const MatrixD& x, const MatrixXd& gram, math::Covariance covariance,
                                       bool isotropic, std::span<const StationaryKernel> starts) {
  const Index n = isotropic ? 1 : x.cols();
  const auto objective = [&](const VectorXd& theta, VectorXd& gradient) {
    return stationary_objective(x, gram, covariance, theta, gradient);
  };
  std::vector<VectorXd> thetas;
  for (const auto& from : starts) {
    VectorXd& theta = thetas.emplace_back(n + 1);
    for (Index j = 0; j < n; ++j) theta[j] = std::log(from.lengths[std::min(j, from.lengths.size() - 1)]);
    theta[n] = std::log(from.noise);
  }
  const math::Minimum best =
      least(logarithm(objective), thetas, {logs(n, 0.3, {1e-8}), logs(n, 1e3, {100})}, search_to_the_end);
  StationaryKernel kernel{VectorXd(x.cols()), std::exp(best.x[n]), std::exp(best.value)};
  for (Index j = 0; j < x.cols(); ++j) kernel.lengths[j] = std::exp(best.x[std::min(j, n - 1)]);
  return kernel;
}

model::SmootherKernel fit_symmetric_kernel(const MatrixD& z, const std::vector<Index>& used,
                                           const MatrixXd& gram, math::Covariance covariance,
                                           const model::SmootherKernel* near) {
  const MatrixD x = columns(z, used);
  const auto p = x.cols();
  const auto error = [&](const MatrixXd& k, double noise, MatrixXd* slope) {
    return leave_one_out_error(k, noise, gram, slope);
  };
  const auto objective = [&](const VectorXd& theta, VectorXd& gradient) {
    return symmetric_objective(x, covariance, error, theta, gradient);
  };
  std::vector<VectorXd> starts{logs(p, 4, {0.3, 0.3}), logs(p, 2, {0.3, 1e-4})};
  if (near != nullptr) starts = {symmetric_start(*near, used)};
  const math::Minimum best =
      least(logarithm(objective), starts, symmetric_bounds(p), near == nullptr ? search : search_nearby);
  return symmetric_kernel(best.x, used, z.cols(), covariance);
}

model::SmootherKernel fit_mode_kernel(const MatrixD& z, const VectorXd& coefficients,
                                      const model::SmootherKernel& field) {
  std::vector<Index> used;
  for (Index j = 0; j < z.cols(); ++j)
    if (field.inverse_lengths[j] > 0) used.push_back(j);
  const MatrixD x = columns(z, used);
  const VectorXd start = symmetric_start(field, used);
  VectorXd spread = VectorXd::Constant(start.size(), length_departure);
  spread[start.size() - 1] = noise_departure;
  const auto likelihood = [&](const MatrixXd& k, double noise, MatrixXd* slope) {
    return mode_likelihood(k, noise, coefficients, slope);
  };
  const auto objective = [&](const VectorXd& theta, VectorXd& gradient) {
    const VectorXd departure = (theta - start).cwiseQuotient(spread);
    const double value = symmetric_objective(x, field.covariance, likelihood, theta, gradient);
    gradient += departure.cwiseQuotient(spread);
    return value + 0.5 * departure.squaredNorm();
  };
  const Bounds bounds = symmetric_bounds(x.cols());
  const auto best = math::minimise(objective, start, bounds.lower, bounds.upper, search_nearby);
  return symmetric_kernel(best.x, used, z.cols(), field.covariance);
}

model::SmootherKernel fit_antisymmetric_kernel(const MatrixD& z, const model::SmootherKernel& symmetric,
                                               const Asymmetry& from, const MatrixXd& gram,
                                               const model::SmootherKernel* near) {
  const auto n_imbalances = static_cast<Index>(from.imbalances.size());
  const MatrixD a = z * symmetric.inverse_lengths.asDiagonal();
  MatrixD o = MatrixD::Ones(z.rows(), n_imbalances + (from.lasting ? 1 : 0));
  o.leftCols(n_imbalances) = columns(z, from.imbalances);
  const auto p = o.cols();
  const auto objective = [&](const VectorXd& theta, VectorXd& gradient) {
    return antisymmetric_objective(a, o, gram, symmetric.covariance, theta, gradient);
  };
  const math::Minimum best = math::minimise(
      logarithm(objective),
      near == nullptr ? logs(p, usual_weight, {1, 1, 1}) : antisymmetric_start(*near, symmetric, from),
      logs(p, least_weight, {1e-3, 0.2, 0.1}), logs(p, most_weight, {10, 30, 1e4}),
      near == nullptr ? search : search_nearby);
  model::SmootherKernel kernel{.antisymmetric = true,
                               .covariance = symmetric.covariance,
                               .linear = std::exp(best.x[p]),
                               .constant = from.lasting ? std::exp(best.x[n_imbalances]) : 0,
                               .noise = std::exp(best.x[p + 2])};
  kernel.inverse_lengths = symmetric.inverse_lengths * std::exp(-best.x[p + 1]);
  kernel.imbalance = VectorXd::Zero(z.cols());
  kernel.imbalance(from.imbalances) = (0.5 * best.x.head(n_imbalances)).array().exp();
  return kernel;
}

}  // namespace elrom::methods
