// The batched screening against LibTorch: its gradient against autograd, and the networks it ends with
// against a loop of single networks.

#include <gtest/gtest.h>
#include <torch/types.h>

#include "../../train/networks/lane_network.hpp"
#include "sequential_screening.hpp"
#include "support/random_network.hpp"

namespace elrom::networks {
namespace {

using ::torch::Tensor;

constexpr std::size_t n_rows = 24, n_inputs = 7, n_units = 6;

TEST(BatchedScreening, GradientEqualsAutograd) {
  const LaneShape shape(n_inputs, n_units);
  const MatrixF inputs = test::random_matrix(n_rows, n_inputs, base::Seed(1));
  const MatrixF x = pad_inputs(inputs, shape);
  LaneBuffer parameters(shape.n_parameters()), activations(n_rows * shape.u), y(n_rows), error(n_rows),
      gradient(shape.n_parameters());
  base::Random random(base::Seed(2));
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    ColumnParameters values(shape.n_parameters());
    for (auto& value : values) value = static_cast<float>(random.normal());
    put_lane(parameters, lane, values);
  }
  const MatrixF targets = test::random_matrix(n_rows, n_lanes, base::Seed(3));

  lanes_forward(shape, parameters, x.data(), n_rows, activations.data(), y.data());
  for (std::size_t r = 0; r < n_rows; ++r)
    for (std::size_t lane = 0; lane < n_lanes; ++lane)
      error[r].value[lane] =
          2.0F / n_rows *
          (y[r].value[lane] - targets(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(lane)));
  lanes_backward(shape, parameters, x.data(), n_rows, activations.data(), error.data(), gradient);

  const auto k = static_cast<std::int64_t>(shape.k), u = static_cast<std::int64_t>(shape.u);
  const Tensor torch_x = ::torch::from_blob(const_cast<float*>(x.data()), {n_rows, k}).clone();
  for (std::size_t lane = 0; lane < n_lanes; ++lane) {
    auto values = get_lane(parameters, lane);
    const Tensor p = ::torch::tensor(values).set_requires_grad(true);
    const Tensor h = ::torch::relu(torch_x.matmul(p.slice(0, 0, k * u).view({k, u})));
    const Tensor out = h.matmul(p.slice(0, k * u, k * u + u)) + p[k * u + u];
    const MatrixF column = targets.col(static_cast<Eigen::Index>(lane));
    ::torch::mse_loss(out, ::torch::from_blob(const_cast<float*>(column.data()), {n_rows}).clone())
        .backward();
    auto ours = get_lane(gradient, lane);
    const Tensor difference = ::torch::tensor(ours) - p.grad();
    EXPECT_LT(difference.norm().item<double>(), 1e-5 * p.grad().norm().item<double>()) << "lane " << lane;
  }
}

ScreeningData noisy_columns() {
  ScreeningData data;
  const Eigen::Index n_cases = 40, n_planes = 4, n_columns = 12;
  data.n_planes = n_planes;
  data.inputs.resize(n_cases * n_planes, 4);
  data.targets.resize(n_cases * n_planes, n_columns);
  const MatrixF cases = test::random_matrix(n_cases, 3, base::Seed(4));
  const MatrixF noise = test::random_matrix(n_cases * n_planes, n_columns, base::Seed(5));
  for (Eigen::Index r = 0; r < n_cases * n_planes; ++r) {
    const Eigen::Index i = r / n_planes;
    data.inputs.row(r) << cases.row(i), static_cast<float>(r % n_planes) - 1.5F;
    for (Eigen::Index c = 0; c < n_columns; ++c) {
      const float share = static_cast<float>(c) / n_columns;
      data.targets(r, c) =
          (1 - share) * std::sin(cases(i, 0) + 0.5F * cases(i, 1)) * 1.4F + share * noise(r, c);
    }
    data.plane.push_back(static_cast<std::int32_t>(r % n_planes));
    data.case_of.push_back(static_cast<std::int32_t>(i));
    data.part.push_back(i % 10 < 7 ? Part::train : i % 10 < 9 ? Part::validation : Part::test);
  }
  return data;
}

TEST(BatchedScreening, EndsWithTheErrorsOfTheLoopOfSingleNetworks) {
  const auto data = noisy_columns();
  ScreenSettings settings;
  settings.builds = 2;
  settings.max_epochs = 25;
  settings.n_units = 6;
  settings.batch_size = 30;
  settings.learning_rate = 5e-3;
  const std::vector<std::uint32_t> columns{0, 3, 11};

  const auto batched = networks::screen_networks(data, settings, {.seed = base::Seed(6)});
  const auto single = benchmark::screen_sequentially(data, settings, base::Seed(6), columns);

  for (Eigen::Index b = 0; b < 2; ++b)
    for (Eigen::Index c = 0; c < 3; ++c) {
      const double expected = single.build_error(b, c);
      // The same start, order and rules; only the rounding of
      // float32 sums differs, and grows over the epochs.
      EXPECT_NEAR(batched.build_error(b, columns[static_cast<std::size_t>(c)]), expected, 0.02 * expected);
    }
}

}  // namespace
}  // namespace elrom::networks
