#include "elrom/math/optimise.hpp"

#include <cmath>
#include <deque>
#include <vector>

#include "elrom/base/error.hpp"

namespace elrom::math {

namespace {

using Eigen::VectorXd;

struct Pair {
  VectorXd step, change;  // of x and of the gradient
};

struct Box {
  const VectorXd &lower, &upper;
  [[nodiscard]] VectorXd project(const VectorXd& x) const { return x.cwiseMax(lower).cwiseMin(upper); }
  /// 1 where x may move against the gradient, 0 where a bound holds it.
  [[nodiscard]] VectorXd free(const VectorXd& x, const VectorXd& gradient) const {
    VectorXd mask = VectorXd::Ones(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if ((x[i] <= lower[i] && gradient[i] > 0) || (x[i] >= upper[i] && gradient[i] < 0)) mask[i] = 0;
    }
    return mask;
  }
};

/// Two-loop recursion on the free variables.
VectorXd direction(const VectorXd& gradient, const VectorXd& mask, const std::deque<Pair>& memory) {
  VectorXd q = gradient.cwiseProduct(mask);
  std::vector<double> alpha(memory.size()), rho(memory.size());
  double scale = 1 / std::max(1.0, q.norm());
  for (std::size_t i = memory.size(); i-- > 0;) {
    const VectorXd step = memory[i].step.cwiseProduct(mask), change = memory[i].change.cwiseProduct(mask);
    const double curvature = step.dot(change);
    rho[i] = curvature > 1e-14 * change.squaredNorm() ? 1 / curvature : 0;  // 0: the pair says nothing here
    alpha[i] = rho[i] * step.dot(q);
    q -= alpha[i] * change;
    if (i + 1 == memory.size() && rho[i] > 0) scale = curvature / change.squaredNorm();
  }
  q *= scale;
  for (std::size_t i = 0; i < memory.size(); ++i) {
    const VectorXd step = memory[i].step.cwiseProduct(mask), change = memory[i].change.cwiseProduct(mask);
    q += step * (alpha[i] - rho[i] * change.dot(q));
  }
  return -q.cwiseProduct(mask);
}

struct Point {
  VectorXd x, gradient;
  double value;
};

/// Halves the step until the value falls enough (Armijo on the
/// projected path). @return false: nothing better found
bool line_search(const Objective& objective, const Box& box, const Point& from, const VectorXd& d,
                 Point& to) {
  constexpr double enough = 1e-4;
  double length = 1;
  for (int i = 0; i < 30; ++i, length *= 0.5) {
    to.x = box.project(from.x + length * d);
    const double predicted = from.gradient.dot(to.x - from.x);
    if (predicted >= 0) continue;
    to.value = objective(to.x, to.gradient);
    if (std::isfinite(to.value) && to.gradient.allFinite() && to.value <= from.value + enough * predicted)
      return true;
  }
  return false;
}

}  // namespace

Minimum minimise(const Objective& objective, const VectorXd& start, const VectorXd& lower,
                 const VectorXd& upper, const MinimiseOptions& options) {
  const Box box{lower, upper};
  Point now{box.project(start), VectorXd::Zero(start.size()), 0};
  now.value = objective(now.x, now.gradient);
  if (!std::isfinite(now.value) || !now.gradient.allFinite()) {
    throw NumericalError("minimise: the function is not finite at the starting point");
  }
  Point next{now.x, now.gradient, now.value};
  std::deque<Pair> memory;
  int iteration = 0;
  for (; iteration < options.max_iterations; ++iteration) {
    const VectorXd mask = box.free(now.x, now.gradient);
    const VectorXd free_gradient = now.gradient.cwiseProduct(mask);
    if (free_gradient.lpNorm<Eigen::Infinity>() <= options.gradient_tolerance) break;
    VectorXd d = direction(now.gradient, mask, memory);
    if (d.dot(free_gradient) > -1e-12 * d.norm() * free_gradient.norm()) {
      memory.clear();
      d = direction(now.gradient, mask, memory);
    }
    if (!line_search(objective, box, now, d, next)) {
      if (memory.empty()) break;
      memory.clear();  // the curvature learned so far misleads; try the gradient itself once
      continue;
    }
    Pair pair{next.x - now.x, next.gradient - now.gradient};
    const double decrease = now.value - next.value;
    std::swap(now, next);
    if (pair.step.dot(pair.change) > 1e-12 * pair.step.norm() * pair.change.norm()) {
      memory.push_back(std::move(pair));
      if (memory.size() > static_cast<std::size_t>(options.memory)) memory.pop_front();
    }
    if (decrease <= options.value_tolerance * std::max(1.0, std::abs(now.value))) break;
  }
  return {now.x, now.value, iteration};
}

}  // namespace elrom::math
