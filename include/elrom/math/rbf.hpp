#pragma once
// Interpolation and smoothing by radial basis functions with a polynomial tail (Wahba 1990, chapter 2;
// Fasshauer 2007, chapter 6): f(x) = sum_i w_i phi(|x - x_i|) + tail(x), (Phi + smoothing I) w + P c = y, P^T
// w = 0.

#include <Eigen/Core>
#include <span>
#include <string_view>

#include "elrom/math/matrix.hpp"

namespace elrom::math {

/// Signs make phi conditionally positive definite: -r, r^2 log r, r^3.
enum class RadialFunction { linear, thin_plate_spline, cubic };
[[nodiscard]] std::string_view name_of(RadialFunction function);
/// @throws InputError with the known names
[[nodiscard]] RadialFunction radial_function_of(std::string_view name);
[[nodiscard]] double radial(RadialFunction function, double r);

struct RbfOptions {
  RadialFunction function = RadialFunction::linear;
  double smoothing = 0;  ///< 0 interpolates
  int degree = -1;       ///< of the tail: 0 or 1; -1: the least that the function needs (linear 0, others 1)
};

/// Thread rule: const use from any thread.
class RbfInterpolator {
 public:
  RbfInterpolator() = default;
  /// @param x (n, n_inputs) @param y (n, n_targets). With too few points for a tail of degree 1, degree 0 is
  /// used; points that repeat, or do not span the tail, get the solution of least norm.
  RbfInterpolator(MatrixD x, const Eigen::MatrixXd& y, const RbfOptions& options);
  /// From stored parts.
  RbfInterpolator(RadialFunction function, MatrixD x, MatrixD weights, MatrixD tail);

  [[nodiscard]] RadialFunction function() const { return function_; }
  [[nodiscard]] const MatrixD& points() const { return x_; }
  [[nodiscard]] const MatrixD& weights() const { return weights_; }  //!< (n, n_targets)
  [[nodiscard]] const MatrixD& tail() const { return tail_; }        //!< (1 or 1 + n_inputs, n_targets)

  /// @param x (n_inputs) @param y (n_targets)
  void evaluate(std::span<const double> x, std::span<double> y) const;

 private:
  RadialFunction function_ = RadialFunction::linear;
  MatrixD x_, weights_, tail_;
};

/// Truth minus the prediction of an interpolator that did not see that point, closed form, (n, n_targets):
/// w_i over the i-th diagonal entry of the system's inverse (Rippa 1999, with smoothing and tail).
[[nodiscard]] Eigen::MatrixXd rbf_leave_one_out(const MatrixD& x, const Eigen::MatrixXd& y,
                                                const RbfOptions& options);

}  // namespace elrom::math
