#include "elrom/math/rbf.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "elrom/base/enum_names.hpp"
#include "elrom/math/kernel.hpp"
#include "elrom/math/linear_algebra.hpp"

namespace elrom::math {

namespace {

constexpr base::EnumNames<RadialFunction, 3> radial_functions{
    "radial function",
    {{RadialFunction::linear, "linear"},
     {RadialFunction::thin_plate_spline, "thin_plate_spline"},
     {RadialFunction::cubic, "cubic"}}};

int tail_degree(const RbfOptions& options, const MatrixD& x) {
  const int least = options.function == RadialFunction::linear ? 0 : 1;
  const int degree = options.degree < 0 ? least : std::min(options.degree, 1);
  return x.rows() > x.cols() + 1 ? degree : 0;
}

MatrixD tail_terms(const MatrixD& x, int degree) {
  MatrixD terms = MatrixD::Ones(x.rows(), degree == 0 ? 1 : 1 + x.cols());
  if (degree > 0) terms.rightCols(x.cols()) = x;
  return terms;
}

/// [Phi + smoothing I, P; P^T, 0]
Eigen::MatrixXd system_of(const MatrixD& x, const RbfOptions& options) {
  const MatrixD terms = tail_terms(x, tail_degree(options, x));
  const Eigen::Index n = x.rows(), n_tail = terms.cols();
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + n_tail, n + n_tail);
  Eigen::MatrixXd distances = squared_distances(x, x).cwiseSqrt();
  distances.diagonal().setZero();
  system.topLeftCorner(n, n) = distances.unaryExpr([&](double r) { return radial(options.function, r); });
  system.topLeftCorner(n, n).diagonal().array() += options.smoothing;
  system.topRightCorner(n, n_tail) = terms;
  system.bottomLeftCorner(n_tail, n) = terms.transpose();
  return system;
}

Eigen::MatrixXd padded(const Eigen::MatrixXd& y, const MatrixD& x, const RbfOptions& options) {
  const Eigen::Index n_tail = tail_degree(options, x) == 0 ? 1 : 1 + x.cols();
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(y.rows() + n_tail, y.cols());
  right.topRows(y.rows()) = y;
  return right;
}

Eigen::MatrixXd solve(const Eigen::MatrixXd& system, const Eigen::MatrixXd& right) {
  const Eigen::MatrixXd solution = system.partialPivLu().solve(right);
  const double error = (system * solution - right).norm();
  if (error <= 1e-8 * (system.norm() * solution.norm() + right.norm())) return solution;
  return least_norm_solution(system, right);  // repeated points, or constant inputs under a tail of degree 1
}

}  // namespace

std::string_view name_of(RadialFunction function) { return radial_functions.name(function); }
RadialFunction radial_function_of(std::string_view name) { return radial_functions.value(name); }

double radial(RadialFunction function, double r) {
  switch (function) {
    case RadialFunction::linear:
      return -r;
    case RadialFunction::thin_plate_spline:
      return r > 0 ? r * r * std::log(r) : 0;
    case RadialFunction::cubic:
      return r * r * r;
  }
  return 0;
}

RbfInterpolator::RbfInterpolator(MatrixD x, const Eigen::MatrixXd& y, const RbfOptions& options)
    : function_(options.function), x_(std::move(x)) {
  check(x_.rows() == y.rows(), "RBF: as many targets as points");
  const Eigen::MatrixXd solution = solve(system_of(x_, options), padded(y, x_, options));
  weights_ = solution.topRows(x_.rows());
  tail_ = solution.bottomRows(solution.rows() - x_.rows());
}

Eigen::MatrixXd rbf_leave_one_out(const MatrixD& x, const Eigen::MatrixXd& y, const RbfOptions& options) {
  const Eigen::MatrixXd system = system_of(x, options);
  const Eigen::MatrixXd inverse = solve(system, Eigen::MatrixXd::Identity(system.rows(), system.cols()));
  const Eigen::Index n = x.rows();
  const Eigen::MatrixXd weights = inverse.topLeftCorner(n, n) * y;
  return weights.array().colwise() / inverse.diagonal().head(n).array();
}

RbfInterpolator::RbfInterpolator(RadialFunction function, MatrixD x, MatrixD weights, MatrixD tail)
    : function_(function), x_(std::move(x)), weights_(std::move(weights)), tail_(std::move(tail)) {
  check(weights_.rows() == x_.rows() && tail_.cols() == weights_.cols(), "RBF: shapes of stored parts");
}

void RbfInterpolator::evaluate(std::span<const double> x, std::span<double> y) const {
  const Eigen::Map<const Eigen::RowVectorXd> at(x.data(), static_cast<Eigen::Index>(x.size()));
  Eigen::Map<Eigen::RowVectorXd> out(y.data(), static_cast<Eigen::Index>(y.size()));
  out = tail_.row(0);
  for (Eigen::Index j = 1; j < tail_.rows(); ++j) out += at[j - 1] * tail_.row(j);
  for (Eigen::Index i = 0; i < x_.rows(); ++i) {
    out += radial(function_, (at - x_.row(i)).norm()) * weights_.row(i);
  }
}

}  // namespace elrom::math
