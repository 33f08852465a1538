#include "elrom/math/rbf.hpp"

#include <gtest/gtest.h>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "elrom/math/statistics.hpp"
#include "support/throws.hpp"

namespace elrom::math {
namespace {

MatrixD points(Eigen::Index n, Eigen::Index p) {
  base::Random random(base::Seed(11).derive("rbf"));
  MatrixD x(n, p);
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] = random.uniform(-1, 1);
  return x;
}

double at(const RbfInterpolator& rbf, const std::vector<double>& x) {
  double y = 0;
  rbf.evaluate(x, std::span(&y, 1));
  return y;
}

TEST(Rbf, LinearFunctionInOneDimensionIsPiecewiseLinear) {
  MatrixD x(3, 1);
  x << 0, 1, 3;

  const RbfInterpolator rbf(x, Eigen::Vector3d(2, 4, 0), {.function = RadialFunction::linear});

  EXPECT_NEAR(at(rbf, {0.5}), 3, 1e-12);
  EXPECT_NEAR(at(rbf, {2}), 2, 1e-12);
}

TEST(Rbf, ReproducesAPlaneWithTailOfDegreeOne) {
  const MatrixD x = points(15, 3);
  const Eigen::MatrixXd y = (x * Eigen::Vector3d(1, -2, 0.5)).array() + 4;

  for (RadialFunction function :
       {RadialFunction::linear, RadialFunction::thin_plate_spline, RadialFunction::cubic}) {
    const RbfInterpolator rbf(x, y, {.function = function, .smoothing = 0.3, .degree = 1});
    EXPECT_NEAR(at(rbf, {5, 6, 7}), 5 - 12 + 3.5 + 4, 1e-8) << name_of(function);
  }
}

TEST(Rbf, InterpolatesWithoutSmoothingAndNotWith) {
  const MatrixD x = points(10, 2);
  const Eigen::MatrixXd y = x.col(0).array() * x.col(1).array();

  const RbfInterpolator exact(x, y, {.function = RadialFunction::cubic});
  const RbfInterpolator smooth(x, y, {.function = RadialFunction::cubic, .smoothing = 1});

  EXPECT_NEAR(at(exact, {x(4, 0), x(4, 1)}), y(4, 0), 1e-10);
  EXPECT_GT(std::abs(at(smooth, {x(4, 0), x(4, 1)}) - y(4, 0)), 1e-3);
}

TEST(Rbf, LeaveOneOutEqualsRefits) {
  const MatrixD x = points(9, 2);
  const Eigen::MatrixXd y = (3 * x.col(0)).array().sin() + x.col(1).array();
  const RbfOptions options{.function = RadialFunction::linear, .smoothing = 0.2};

  const Eigen::MatrixXd closed = rbf_leave_one_out(x, y, options);

  for (std::size_t left = 0; left < 9; ++left) {
    std::vector<std::size_t> rest = all_rows(9);
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(left));
    const auto i = static_cast<Eigen::Index>(left);
    const MatrixD y_rest = take_rows(MatrixD(y), rest);
    const RbfInterpolator refit(take_rows(x, rest), y_rest, options);
    EXPECT_NEAR(closed(i, 0), y(i, 0) - at(refit, {x(i, 0), x(i, 1)}), 1e-10);
  }
}

TEST(Rbf, RepeatedPointsGiveFiniteValues) {
  MatrixD x(4, 1);
  x << 0, 1, 1, 2;

  const RbfInterpolator rbf(x, Eigen::Vector4d(0, 1, 3, 4), {.function = RadialFunction::linear});

  EXPECT_NEAR(at(rbf, {1}), 2, 1e-6);  // least norm: between the two
}

TEST(Rbf, UnknownFunctionNamesTheNearest) {
  EXPECT_ERROR(InputError, "did you mean 'cubic'", radial_function_of("cubik"));
}

}  // namespace
}  // namespace elrom::math
