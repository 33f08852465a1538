#include "field_scale.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elrom/math/optimise.hpp"

namespace elrom::methods {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double steepest = 3;           // largest exponent
constexpr double prior_deviation = 0.6;  // of an exponent about 0
constexpr double least_variance = 0.1;   // few errors may be alike by chance

/// Weight of the exponents' squares beside the logarithm of the cases' summed error. Errors with a relative
/// variance v scatter as the mean squares of 2 / v normal values do (Satterthwaite 1946), so those of n cases
/// weigh n / v times their logarithm.
/// @param errors of the cases over their scales, (n_cases)
double prior_weight(const VectorXd& errors) {
  const auto n = static_cast<double>(errors.size());
  const double mean = errors.mean() + std::numeric_limits<double>::min();
  const double variance = std::max((errors / mean).squaredNorm() / n - 1, least_variance);
  return variance / (2 * n * prior_deviation * prior_deviation);
}

}  // namespace

MatrixXd residual_operation(const MatrixXd& leave_one_out_about_mean) {
  const auto n = leave_one_out_about_mean.rows();
  const double share = 1.0 / static_cast<double>(n - 1);
  MatrixXd residual = -leave_one_out_about_mean;
  residual.array() -= share;
  residual.diagonal().array() += 1 + share;
  return residual;
}

VectorXd scaled_errors(const MatrixXd& residual, const MatrixXd& gram, const VectorXd& scales) {
  const MatrixXd b = residual * scales.cwiseInverse().asDiagonal();
  return (b * gram).cwiseProduct(b).rowwise().sum().cwiseProduct(scales.cwiseAbs2());
}

VectorXd fit_exponents(const MatrixXd& residual, const MatrixXd& gram, const MatrixD& logs,
                       const VectorXd& start) {
  const VectorXd at_start = (logs * start).array().exp();
  const double weight =
      prior_weight(scaled_errors(residual, gram, at_start).cwiseQuotient(at_start.cwiseAbs2()));
  const auto objective = [&](const VectorXd& exponents, VectorXd& gradient) {
    const VectorXd scales = (logs * exponents).array().exp();
    const MatrixXd b = residual * scales.cwiseInverse().asDiagonal();
    const MatrixXd bg = b * gram;
    const VectorXd squares = scales.cwiseAbs2();
    const VectorXd errors = bg.cwiseProduct(b).rowwise().sum().cwiseProduct(squares);
    const double sum = errors.sum() + std::numeric_limits<double>::min();
    // By log s_i: of the case's own scale, and of 1 / s_i in what the others are predicted from.
    const VectorXd slopes = 2 * (errors - b.cwiseProduct(bg).transpose() * squares);
    gradient = logs.transpose() * slopes / sum + 2 * weight * exponents;
    return std::log(sum) + weight * exponents.squaredNorm();
  };
  const VectorXd bound = VectorXd::Constant(start.size(), steepest);
  return math::minimise(objective, start, -bound, bound).x;
}

}  // namespace elrom::methods
