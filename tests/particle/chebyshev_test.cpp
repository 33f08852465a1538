#include "elrom/particle/chebyshev.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "elrom/base/error.hpp"

namespace elrom::particle {
namespace {

// f = 1 + 2 T1(x) T2(y) on the panel [0, 1], y in [0, 4]; 5 on [1, 2].
Chebyshev two_panels() {
  MatrixD coefficients = MatrixD::Zero(2, 6);  // terms: 1, T1(y), T2(y), then times T1(x)
  coefficients(0, 0) = 1;
  coefficients(0, 5) = 2;
  coefficients(1, 0) = 5;
  return {
      {.n_inputs = 2, .n_outputs = 1, .degree_x = 1, .degree_y = 2}, {0, 1, 2}, {0, 0}, {2, 4}, coefficients};
}

double at(const Regressor& regressor, double x, double y) {
  Table inputs(1, 2), outputs(1, 1);
  inputs << x, y;
  regressor.evaluate(inputs, outputs);
  return outputs(0, 0);
}

TEST(Chebyshev, SumsProductsOfPolynomials) {
  // x = 0.75: T1 = 0.5; y = 3: place 0.5, T2 = 2 0.25 - 1 = -0.5
  EXPECT_DOUBLE_EQ(at(two_panels(), 0.75, 3), 1 + 2 * 0.5 * -0.5);
  EXPECT_DOUBLE_EQ(at(two_panels(), 0.75, 4), 1 + 2 * 0.5);
}

TEST(Chebyshev, FindsThePanelToItsEdges) {
  EXPECT_DOUBLE_EQ(at(two_panels(), std::nextafter(1.0, 0.0), 4), 3);
  EXPECT_DOUBLE_EQ(at(two_panels(), 1, 4), 5);
  EXPECT_DOUBLE_EQ(at(two_panels(), 2, 4), 5);
}

TEST(Chebyshev, ValuesOutsideCountAsTheNearestEnd) {
  EXPECT_DOUBLE_EQ(at(two_panels(), -7, 4), at(two_panels(), 0, 4));
  EXPECT_DOUBLE_EQ(at(two_panels(), 99, 1), 5);
  EXPECT_DOUBLE_EQ(at(two_panels(), 0.75, 1e300), at(two_panels(), 0.75, 4));
}

// The first three outputs are even in the orbit beside the slip, the others odd.
TEST(Chebyshev, MirrorImagesAgree) {
  const Chebyshev::Shape shape{.n_inputs = 5, .n_outputs = 5, .degree_x = 1, .degree_y = 1};
  MatrixD coefficients = MatrixD::Random(static_cast<Eigen::Index>(shape.n_rows()), 4);
  const Chebyshev regressor(shape, {0, 1}, {0, 0, -4, -4, -4}, {1, 1, 4, 4, 4}, coefficients);
  Table inputs(2, 5), outputs(2, 5);
  inputs << 0.3, 0.6, 1.5, 0.7, -0.9,  //
      0.3, 0.6, 1.5, -0.7, 0.9;
  regressor.evaluate(inputs, outputs);
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(outputs(0, k), outputs(1, k), 1e-14);
  for (int k = 3; k < 5; ++k) EXPECT_NEAR(outputs(0, k), -outputs(1, k), 1e-14);
  EXPECT_GT(std::abs(outputs(0, 3)), 1e-3);
}

TEST(Chebyshev, ComesBackFromAFile) {
  io::TensorFile file;
  two_panels().write(file, "f");
  const auto back = read_regressor(file, "f");
  EXPECT_EQ(back->kind(), "chebyshev");
  EXPECT_EQ(at(*back, 0.6, 3.3), at(two_panels(), 0.6, 3.3));
}

TEST(Chebyshev, RefusesWhatCannotBeEvaluated) {
  const Chebyshev::Shape shape{.n_inputs = 2, .n_outputs = 1, .degree_x = 0, .degree_y = 0};
  const auto make = [&](const Chebyshev::Shape& s, std::vector<double> edges, double high,
                        MatrixD coefficients) {
    return Chebyshev(s, std::move(edges), {0, 0}, {1, high}, std::move(coefficients));
  };
  EXPECT_NO_THROW(make(shape, {0, 1}, 1, MatrixD::Ones(1, 1)));
  EXPECT_THROW(make(shape, {0}, 1, MatrixD::Ones(1, 1)), InputError);
  EXPECT_THROW(make(shape, {1, 0}, 1, MatrixD::Ones(1, 1)), InputError);
  EXPECT_THROW(make(shape, {0, NAN}, 1, MatrixD::Ones(1, 1)), InputError);
  EXPECT_THROW(make(shape, {0, 1}, INFINITY, MatrixD::Ones(1, 1)), InputError);
  EXPECT_THROW(make(shape, {0, 1}, 1, MatrixD::Ones(2, 1)), InputError);
  EXPECT_THROW(make(shape, {0, 1}, 1, MatrixD::Constant(1, 1, NAN)), InputError);
  auto wide = shape;
  wide.degree_x = 1'000'000'000;
  EXPECT_THROW(make(wide, {0, 1}, 1, MatrixD::Ones(1, 1)), InputError);
  auto inputs = shape;
  inputs.n_inputs = 3;
  EXPECT_THROW(make(inputs, {0, 1}, 1, MatrixD::Ones(1, 1)), InputError);
}

// Constants: panel p, output o gives 10 p + o.
TEST(Chebyshev, EachPanelHasItsOwnOutputs) {
  MatrixD coefficients(6, 1);
  coefficients << 0, 1, 10, 11, 20, 21;
  const Chebyshev regressor({.n_inputs = 2, .n_outputs = 2, .degree_x = 0, .degree_y = 0}, {0, 1, 1.001, 3},
                            {0, 0}, {3, 1}, coefficients);
  Table inputs(3, 2), outputs(3, 2);
  inputs << 0.999, 0, 1.0005, 0, 2.9, 0;
  regressor.evaluate(inputs, outputs);
  for (int panel = 0; panel < 3; ++panel)
    for (int output = 0; output < 2; ++output) EXPECT_DOUBLE_EQ(outputs(panel, output), 10 * panel + output);
}

}  // namespace
}  // namespace elrom::particle
