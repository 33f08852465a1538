#include "elrom/model/network.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "elrom/base/error.hpp"
#include "support/random_network.hpp"

namespace elrom::model {
namespace {

using test::random_matrix;
using test::random_network;

double activated(Activation activation, double z) {
  switch (activation) {
    case Activation::relu:
      return std::max(z, 0.0);
    case Activation::tanh:
      return std::tanh(z);
    case Activation::silu:
      return z / (1 + std::exp(-z));
  }
  return 0;
}

// The definition, in double, one output at a time.
std::vector<double> reference(const Network& network, std::vector<double> x) {
  for (std::size_t i = 0; i < network.layers().size(); ++i) {
    const auto weights = network.layers()[i].weights.matrix();
    const auto bias = network.layers()[i].bias.f32();
    std::vector<double> y(bias.begin(), bias.end());
    for (Eigen::Index o = 0; o < weights.rows(); ++o)
      for (Eigen::Index k = 0; k < weights.cols(); ++k)
        y[static_cast<std::size_t>(o)] += double{weights(o, k)} * x[static_cast<std::size_t>(k)];
    if (i + 1 < network.layers().size())
      for (double& value : y) value = activated(network.activation(), value);
    x = y;
  }
  return x;
}

class Forward : public ::testing::TestWithParam<Activation> {};

TEST_P(Forward, EqualsTheDefinition) {
  const auto network = random_network({29, 50, 37, 11}, GetParam(), base::Seed(3));
  const MatrixF x = random_matrix(83, 29, base::Seed(4));
  MatrixF y(83, 11);
  Workspace workspace;

  network.forward(x, y, workspace);

  for (Eigen::Index r = 0; r < x.rows(); ++r) {
    const auto expected = reference(network, std::vector<double>(x.row(r).data(), x.row(r).data() + 29));
    for (Eigen::Index o = 0; o < 11; ++o) EXPECT_NEAR(y(r, o), expected[static_cast<std::size_t>(o)], 1e-5);
  }
}

TEST_P(Forward, ARowsBitsDoNotDependOnTheOtherRows) {
  const auto network = random_network({27, 130, 19, 42}, GetParam(), base::Seed(5));
  const MatrixF x = random_matrix(150, 27, base::Seed(6));
  MatrixF all(150, 42), one(1, 42);
  Workspace workspace;

  network.forward(x, all, workspace);

  for (Eigen::Index r = 0; r < x.rows(); ++r) {
    network.forward(x.row(r), one, workspace);
    ASSERT_TRUE((one.array() == all.row(r).array()).all()) << "row " << r;
  }
}

TEST_P(Forward, StaysFiniteForHugeInputs) {
  const auto network = random_network({4, 8, 3}, GetParam(), base::Seed(7));
  MatrixF x(2, 4), y(2, 3);
  x << 1e6F, -1e6F, 1e6F, 1e6F, -1e6F, -1e6F, 1e6F, 0;
  Workspace workspace;

  network.forward(x, y, workspace);

  EXPECT_TRUE(y.allFinite()) << y;
}

INSTANTIATE_TEST_SUITE_P(AllActivations, Forward,
                         ::testing::Values(Activation::relu, Activation::tanh, Activation::silu),
                         [](const auto& test) { return std::string(name_of(test.param)); });

TEST(Network, SharingTheFirstInputsGivesTheSameValues) {
  const auto network = random_network({30, 40, 6}, Activation::silu, base::Seed(8));
  MatrixF x = random_matrix(20, 30, base::Seed(9));
  for (Eigen::Index r = 1; r < 20; ++r) x.row(r).head(26) = x.row(0).head(26);
  MatrixF expected(20, 6);
  Workspace workspace;
  network.forward(x, expected, workspace);
  const auto own = workspace.floats(4 * 32), out = workspace.floats(6 * 32);
  std::fill(own.begin(), own.end(), 0.0F);
  MapF(own.data(), 4, 32).leftCols(20) = x.rightCols(4).transpose();

  network.forward_shared({x.data(), 26}, own, 20, out, workspace);

  const MatrixF shared = ConstMapF(out.data(), 6, 32).leftCols(20).transpose();
  EXPECT_TRUE((shared.array() == expected.array()).all()) << "the order of additions is the same";
}

TEST(Network, HalvedWeightsGiveThreeDigits) {
  const auto network = random_network({27, 64, 64, 20}, Activation::relu, base::Seed(10));
  const MatrixF x = random_matrix(66, 27, base::Seed(11));
  MatrixF full(66, 20), half(66, 20);
  Workspace workspace;

  network.forward(x, full, workspace);
  network.halved().forward(x, half, workspace);

  const float difference = (full - half).norm() / full.norm();  // relative to the norm of all outputs
  EXPECT_LT(difference, 2e-3F);
  EXPECT_GT(difference, 0);
}

TEST(Network, ReadsBackWhatItSaved) {
  const auto network = random_network({5, 7, 3}, Activation::tanh, base::Seed(12));
  const MatrixF x = random_matrix(4, 5, base::Seed(13));
  MatrixF before(4, 3), after(4, 3);
  Workspace workspace;
  io::TensorFile file;

  network.save(file, "model/net");
  const auto loaded = Network::load(file, "model/net");
  network.forward(x, before, workspace);
  loaded.forward(x, after, workspace);

  EXPECT_EQ(loaded.activation(), Activation::tanh);
  EXPECT_EQ(before, after);
}

TEST(Network, RefusesLayersThatDoNotFit) {
  const auto first = random_network({5, 7}, Activation::relu, base::Seed(1)).layers()[0];
  const auto second = random_network({6, 3}, Activation::relu, base::Seed(1)).layers()[0];

  try {
    const Network network({first, second}, Activation::relu);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("layer 2"));
    EXPECT_THAT(error.what(), ::testing::HasSubstr("7 inputs"));
  }
}

TEST(Network, UnknownActivationNamesTheNearest) {
  try {
    (void)activation_of("rleu");
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("'relu'"));
  }
}

}  // namespace
}  // namespace elrom::model
