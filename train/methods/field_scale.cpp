#include "field_scale.hpp"

#include <cmath>
#include <limits>

#include "elrom/math/optimise.hpp"

namespace elrom::methods {

namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double steepest = 3;  // largest exponent
/// Weight of an exponent's square beside the logarithm of the error, times the number of cases: 1 would be
/// that of a normal prior of deviation 1, if the cases' errors were independent.
constexpr double caution = 0.1;

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
  const double weight = caution / static_cast<double>(logs.rows());
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
