#include "elrom/math/optimise.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"

namespace elrom::math {
namespace {

double rosenbrock(const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
  const double a = 1 - x[0], b = x[1] - x[0] * x[0];
  gradient.resize(2);
  gradient << -2 * a - 400 * x[0] * b, 200 * b;
  return a * a + 100 * b * b;
}

const Eigen::Vector2d low(-5, -5), high(5, 5);

TEST(Minimise, FindsTheRosenbrockMinimum) {
  const Minimum found = minimise(rosenbrock, Eigen::Vector2d(-1.2, 1), low, high,
                                 {.max_iterations = 200, .gradient_tolerance = 1e-9, .value_tolerance = 0});

  EXPECT_NEAR(found.x[0], 1, 1e-6);
  EXPECT_NEAR(found.x[1], 1, 1e-6);
}

TEST(Minimise, StaysInTheBoxAndFindsTheBoundMinimum) {
  // With x_0 <= 0.5 the minimum is at (0.5, 0.25), value 0.25.
  const Minimum found = minimise(rosenbrock, Eigen::Vector2d(-1.2, 1), low, Eigen::Vector2d(0.5, 5),
                                 {.max_iterations = 200, .gradient_tolerance = 1e-9, .value_tolerance = 0});

  EXPECT_DOUBLE_EQ(found.x[0], 0.5);
  EXPECT_NEAR(found.value, 0.25, 1e-9);
}

TEST(Minimise, StepsBackFromValuesThatAreNotFinite) {
  const Objective walled = [](const Eigen::VectorXd& x, Eigen::VectorXd& gradient) {
    gradient = Eigen::VectorXd::Constant(1, 1 - 1 / x[0]);
    return x[0] > 0 ? x[0] - std::log(x[0]) : std::numeric_limits<double>::quiet_NaN();
  };

  const Minimum found = minimise(walled, Eigen::VectorXd::Constant(1, 4), Eigen::VectorXd::Constant(1, -10),
                                 Eigen::VectorXd::Constant(1, 10));

  EXPECT_NEAR(found.x[0], 1, 1e-3);
}

TEST(Minimise, RefusesAStartWithoutAValue) {
  const Objective broken = [](const Eigen::VectorXd&, Eigen::VectorXd& gradient) {
    gradient.setZero(2);
    return std::numeric_limits<double>::infinity();
  };

  EXPECT_THROW((void)minimise(broken, Eigen::Vector2d(0, 0), low, high), NumericalError);
}

}  // namespace
}  // namespace elrom::math
