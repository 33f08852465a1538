#pragma once
// Minimum of a smooth function inside a box, from its gradient: limited-memory BFGS (Nocedal & Wright 2006,
// alg. 7.4) on the variables that are not held by a bound, with a projected backtracking line search.

#include <Eigen/Core>
#include <functional>

namespace elrom::math {

/// Value at x; writes the gradient. A value that is not finite makes the line search step back.
using Objective = std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd& gradient)>;

struct MinimiseOptions {
  int max_iterations = 100;
  int memory = 10;
  double gradient_tolerance = 1e-5;  ///< on the projected gradient's largest entry
  double value_tolerance = 1e-8;     ///< relative decrease of one step below which it stops
};

struct Minimum {
  Eigen::VectorXd x;
  double value = 0;
  int iterations = 0;
};

/// @throws NumericalError when the value at `start` (moved into the box) is not finite
[[nodiscard]] Minimum minimise(const Objective& objective, const Eigen::VectorXd& start,
                               const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                               const MinimiseOptions& options = {});

}  // namespace elrom::math
