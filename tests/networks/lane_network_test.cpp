#include "lane_network.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elrom/base/random.hpp"

namespace elrom::networks {
namespace {

constexpr std::size_t n_rows = 12, n_inputs = 5, n_units = 6;

// Straightforward double-precision network with the same weights: the independent implementation.
struct Plain {
  const LaneShape& shape;
  std::vector<double> p;
  double output(const MatrixF& x, Eigen::Index row) const {
    double y = p.back();
    for (std::size_t j = 0; j < shape.u; ++j) {
      double h = 0;
      for (std::size_t k = 0; k < shape.k; ++k)
        h += p[k * shape.u + j] * x(row, static_cast<Eigen::Index>(k));
      y += std::max(h, 0.0) * p[shape.k * shape.u + j];
    }
    return y;
  }
};

class Lanes : public ::testing::Test {
 protected:
  Lanes()
      : parameters(shape.n_parameters()),
        activations(n_rows * shape.u),
        y(n_rows),
        error(n_rows),
        gradient(shape.n_parameters()) {
    base::Random random(base::Seed(3));
    MatrixF inputs(n_rows, n_inputs);
    for (auto& value : inputs.reshaped()) value = static_cast<float>(random.normal());
    x = pad_inputs(inputs, shape);
    for (std::size_t lane = 0; lane < n_lanes; ++lane) {
      ColumnParameters values(shape.n_parameters());
      for (auto& value : values) value = static_cast<float>(random.normal());
      put_lane(parameters, lane, values);
    }
    for (auto& row : error)
      for (auto& value : row.value) value = static_cast<float>(random.normal());
  }
  Plain plain(std::size_t lane) const {
    const auto values = get_lane(parameters, lane);
    return {shape, {values.begin(), values.end()}};
  }

  LaneShape shape{n_inputs, n_units};
  MatrixF x;
  LaneBuffer parameters, activations, y, error, gradient;
};

TEST_F(Lanes, ForwardEqualsPlainArithmetic) {
  lanes_forward(shape, parameters, x.data(), n_rows, activations.data(), y.data());

  for (const std::size_t lane : {0U, 7U, 15U}) {
    for (std::size_t r = 0; r < n_rows; ++r) {
      const double expected = plain(lane).output(x, static_cast<Eigen::Index>(r));
      EXPECT_NEAR(y[r].value[lane], expected, 1e-5 * (1 + std::abs(expected)));
    }
  }
}

TEST_F(Lanes, BackwardEqualsCentralDifferences) {
  lanes_forward(shape, parameters, x.data(), n_rows, activations.data(), y.data());
  lanes_backward(shape, parameters, x.data(), n_rows, activations.data(), error.data(), gradient);

  const std::size_t lane = 9;
  auto network = plain(lane);
  const auto objective = [&] {
    double sum = 0;
    for (std::size_t r = 0; r < n_rows; ++r)
      sum += error[r].value[lane] * network.output(x, static_cast<Eigen::Index>(r));
    return sum;
  };
  for (std::size_t p = 0; p < shape.n_parameters(); ++p) {
    const double h = 1e-6, kept = network.p[p];
    network.p[p] = kept + h;
    const double above = objective();
    network.p[p] = kept - h;
    const double difference = (above - objective()) / (2 * h);
    network.p[p] = kept;
    EXPECT_NEAR(gradient[p].value[lane], difference, 1e-4 * (1 + std::abs(difference))) << "parameter " << p;
  }
}

TEST_F(Lanes, AdamFollowsTheFormula) {
  LaneAdam adam(1);
  LaneBuffer weight(1), slope(1);
  double w = 0.5, m = 0, s = 0;
  weight[0].value[2] = 0.5F;
  for (std::size_t t = 1; t <= 5; ++t) {
    const double g = 0.1 * static_cast<double>(t) - 0.2;
    slope[0].value[2] = static_cast<float>(g);

    adam.step(weight, slope, 0.01, t);

    m = 0.9 * m + 0.1 * g;
    s = 0.999 * s + 0.001 * g * g;
    w -= 0.01 * (m / (1 - std::pow(0.9, t))) / (std::sqrt(s / (1 - std::pow(0.999, t))) + 1e-8);
    EXPECT_NEAR(weight[0].value[2], w, 1e-6);
  }
  EXPECT_EQ(weight[0].value[3], 0) << "a lane without a gradient stays";
}

}  // namespace
}  // namespace elrom::networks
