#include "elrom/particle/network_regressor.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"

namespace elrom::particle {
namespace {

/// y = 2 x1 - x2 + 0.5 of standardised numbers: one layer.
model::Network one_layer() {
  MatrixF weights(1, 2);
  weights << 2, -1;
  const std::vector<float> bias{0.5F};
  return {{{io::Tensor::copy(weights), io::Tensor::copy(bias, {1})}}, model::Activation::tanh};
}

math::Standardiser scaler(std::initializer_list<double> mean, std::initializer_list<double> scale) {
  const auto vector = [](std::initializer_list<double> values) {
    return Eigen::VectorXd(
        Eigen::Map<const Eigen::VectorXd>(values.begin(), static_cast<Eigen::Index>(values.size())));
  };
  return {vector(mean), vector(scale)};
}

NetworkRegressor by_hand() { return {scaler({10, 20}, {4, 2}), scaler({100}, {8}), one_layer()}; }

double value_at(const Regressor& regressor, double x1, double x2) {
  Table inputs(1, 2), outputs(1, 1);
  inputs << x1, x2;
  regressor.evaluate(inputs, outputs);
  return outputs(0, 0);
}

// x standardised: (14 - 10) / 4 = 1, (16 - 20) / 2 = -2; y = 2 + 2 + 0.5; back: 100 + 8 y.
TEST(NetworkRegressor, ScalesInAndOut) { EXPECT_NEAR(value_at(by_hand(), 14, 16), 100 + 8 * 4.5, 1e-5); }

TEST(NetworkRegressor, ComesBackFromAFile) {
  io::TensorFile file;
  by_hand().write(file, "f");
  const auto back = read_regressor(file, "f");
  EXPECT_EQ(back->kind(), "network");
  EXPECT_EQ(back->n_inputs(), 2u);
  EXPECT_EQ(back->n_outputs(), 1u);
  EXPECT_EQ(value_at(*back, 11, 17), value_at(by_hand(), 11, 17));
}

TEST(NetworkRegressor, RefusesScalesThatCannotBe) {
  EXPECT_THROW(NetworkRegressor(scaler({1}, {1}), scaler({1}, {1}), one_layer()), InputError);
  EXPECT_THROW(NetworkRegressor(scaler({1, 1}, {1, 0}), scaler({1}, {1}), one_layer()), InputError);
  EXPECT_THROW(NetworkRegressor(scaler({1, NAN}, {1, 1}), scaler({1}, {1}), one_layer()), InputError);
  EXPECT_THROW(NetworkRegressor(scaler({1, 1}, {1, 1}), scaler({1}, {INFINITY}), one_layer()), InputError);
}

}  // namespace
}  // namespace elrom::particle
