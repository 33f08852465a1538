// The forward pass that ships in elrom::core against LibTorch's, the library the networks are trained with.

#include <gtest/gtest.h>
#include <torch/types.h>

#include <numeric>

#include "elrom/model/banded_networks.hpp"
#include "support/random_network.hpp"

namespace elrom::model {
namespace {

using test::random_matrix;
using test::random_network;
using ::torch::Tensor;

constexpr double tolerance = 1e-5;  // relative to the largest value: float32 sums of some hundred products

Tensor to_torch(const MatrixF& matrix) {
  return ::torch::from_blob(const_cast<float*>(matrix.data()), {matrix.rows(), matrix.cols()}).clone();
}

Tensor to_torch(const io::Tensor& tensor) {
  std::vector<std::int64_t> shape(tensor.shape().begin(), tensor.shape().end());
  return ::torch::from_blob(const_cast<float*>(tensor.f32().data()), shape).clone();
}

Tensor torch_forward(const Network& network, Tensor x) {
  for (std::size_t i = 0; i < network.layers().size(); ++i) {
    x = ::torch::linear(x, to_torch(network.layers()[i].weights), to_torch(network.layers()[i].bias));
    if (i + 1 == network.layers().size()) break;
    switch (network.activation()) {
      case Activation::relu:
        x = ::torch::relu(x);
        break;
      case Activation::tanh:
        x = ::torch::tanh(x);
        break;
      case Activation::silu:
        x = ::torch::silu(x);
        break;
    }
  }
  return x;
}

double largest_difference(const Tensor& a, const Tensor& b) {
  return (a - b).abs().max().item<double>() / std::max(1.0, b.abs().max().item<double>());
}

class Against : public ::testing::TestWithParam<Activation> {};

TEST_P(Against, LibTorchForNetworksOfManyShapes) {
  Workspace workspace;
  for (const auto& widths : std::vector<std::vector<std::size_t>>{
           {27, 5}, {1, 1, 1}, {27, 64, 64, 840}, {39, 256, 128, 64, 200}, {92, 33, 17}}) {
    const auto network = random_network(widths, GetParam(), base::Seed(widths.size()));
    const MatrixF x = random_matrix(66, static_cast<Eigen::Index>(widths.front()), base::Seed(2));
    MatrixF y(66, static_cast<Eigen::Index>(widths.back()));

    network.forward(x, y, workspace);

    EXPECT_LT(largest_difference(to_torch(y), torch_forward(network, to_torch(x))), tolerance);
  }
}

TEST_P(Against, LibTorchForAWholeModelOfBands) {
  for (const auto encoding :
       {PlaneEncodingKind::index, PlaneEncodingKind::fourier, PlaneEncodingKind::one_hot})
    for (const auto transform : {TransformKind::none, TransformKind::log, TransformKind::asinh}) {
      BandedNetworks::Parts parts;
      parts.n_columns = 30;
      parts.planes = {encoding, 20, 4};
      parts.transform = {transform, 0.1F};
      parts.inputs = InputScaler::fit(random_matrix(9, 26, base::Seed(3)).cast<double>());
      parts.outputs = OutputScaler::fit(random_matrix(9, 600, base::Seed(4)), 30, true);
      Submodel submodel{"all", std::vector<std::int32_t>(30), {}, {}, {0.2, 0.1}};
      std::iota(submodel.columns.begin(), submodel.columns.end(), 0);
      for (const std::uint64_t build : {0, 1})
        submodel.builds.push_back(
            random_network({26 + parts.planes.size(), 48, 48, 30}, GetParam(), base::Seed(build)));
      parts.submodels.push_back(submodel);
      const BandedNetworks model(parts);
      const std::vector<double> inputs(26, 0.4);
      std::vector<std::int32_t> planes(20);
      std::iota(planes.begin(), planes.end(), 0);
      std::vector<float> values(600);
      Workspace workspace;

      model.predict({inputs, planes}, values, {}, workspace);

      MatrixF x(20, static_cast<Eigen::Index>(26 + parts.planes.size()));
      for (Eigen::Index plane = 0; plane < 20; ++plane) {
        parts.inputs.apply(inputs, {x.row(plane).data(), 26});
        parts.planes.encode(static_cast<std::size_t>(plane), {x.row(plane).data() + 26, parts.planes.size()});
      }
      Tensor sum = ::torch::zeros({20, 30});
      for (const auto& build : submodel.builds) {
        const Tensor z = to_torch(parts.outputs.mean) +
                         to_torch(parts.outputs.deviation) * torch_forward(build, to_torch(x));
        sum += transform == TransformKind::none  ? z
               : transform == TransformKind::log ? ::torch::exp(z) - 0.1
                                                 : ::torch::sinh(z) * 0.1;
      }
      const Tensor predicted = ::torch::from_blob(values.data(), {20, 30});
      EXPECT_LT(largest_difference(predicted, sum / 2), tolerance)
          << name_of(encoding) << " " << name_of(transform);
    }
}

INSTANTIATE_TEST_SUITE_P(AllActivations, Against,
                         ::testing::Values(Activation::relu, Activation::tanh, Activation::silu),
                         [](const auto& test) { return std::string(name_of(test.param)); });

}  // namespace
}  // namespace elrom::model
