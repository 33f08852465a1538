#include "sequential_screening.hpp"

#include <torch/nn/modules/activation.h>
#include <torch/nn/modules/container/sequential.h>
#include <torch/nn/modules/linear.h>
#include <torch/optim/adam.h>
#include <torch/utils.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace elrom::benchmark {
namespace {

using ::torch::Tensor;
namespace nn = ::torch::nn;

Tensor to_torch(const MatrixF& matrix) {
  return ::torch::from_blob(const_cast<float*>(matrix.data()), {matrix.rows(), matrix.cols()}).clone();
}

Tensor index_of(const std::vector<std::uint32_t>& rows) {
  const std::vector<std::int64_t> wide(rows.begin(), rows.end());
  return ::torch::tensor(wide);
}

/// The records of a part: inputs, and the targets of all columns.
struct Records {
  Tensor inputs, targets;
  Records(const Tensor& all_inputs, const Tensor& all_targets, const std::vector<std::uint32_t>& rows)
      : inputs(all_inputs.index_select(0, index_of(rows))),
        targets(all_targets.index_select(0, index_of(rows))) {}
};

nn::Sequential make_network(const networks::ColumnNetwork& start) {
  const auto n_units = start.hidden.rows(), n_inputs = start.hidden.cols() - 1;
  nn::Linear hidden(n_inputs, n_units), output(n_units, 1);
  const ::torch::NoGradGuard no_gradient;
  hidden->weight.copy_(to_torch(start.hidden.leftCols(n_inputs)));
  hidden->bias.copy_(to_torch(start.hidden.rightCols(1)).flatten());
  const Tensor last = ::torch::tensor(start.output);
  output->weight.copy_(last.slice(0, 0, n_units).view({1, n_units}));
  output->bias.copy_(last.slice(0, n_units, n_units + 1));
  return nn::Sequential(hidden, nn::ReLU(), output);
}

double error_of(nn::Sequential& network, const Tensor& inputs, const Tensor& targets) {
  const ::torch::NoGradGuard no_gradient;
  return ::torch::mse_loss(network->forward(inputs), targets).item<double>();
}

class Loop {
 public:
  Loop(const networks::ScreeningData& data, const networks::ScreenSettings& settings, base::Seed seed)
      : settings_(settings),
        seed_(seed),
        train_rows_(data.rows(networks::Part::train)),
        inputs_(to_torch(data.inputs)),
        targets_(to_torch(data.targets)),
        train_(inputs_, targets_, train_rows_),
        validation_(inputs_, targets_, data.rows(networks::Part::validation)),
        test_(inputs_, targets_, data.judging_rows()) {}

  /// @return error on the test records, epochs
  std::pair<double, int> build(std::size_t i_build, std::uint32_t column) {
    auto network = make_network(networks::initial_network(seed_, i_build, column,
                                                          static_cast<std::size_t>(inputs_.size(1)),
                                                          static_cast<std::size_t>(settings_.n_units)));
    const auto column_of = [&](const Records& records) {
      return records.targets.narrow(1, column, 1).contiguous();
    };
    const Tensor train_targets = column_of(train_), validation_targets = column_of(validation_);
    ::torch::optim::Adam adam(network->parameters(), ::torch::optim::AdamOptions(settings_.learning_rate));
    std::vector<Tensor> best = copy_of(network);
    double best_error = HUGE_VAL;
    int waited = 0, epoch = 0;
    for (; epoch < settings_.max_epochs && waited < settings_.patience; ++epoch) {
      run_epoch(network, adam, train_targets, i_build, static_cast<std::size_t>(epoch));
      const double error = error_of(network, validation_.inputs, validation_targets);
      waited = error < best_error ? 0 : waited + 1;
      if (waited == 0) {
        best_error = error;
        best = copy_of(network);
      }
    }
    restore(network, best);
    return {error_of(network, test_.inputs, column_of(test_)), epoch};
  }

 private:
  void run_epoch(nn::Sequential& network, ::torch::optim::Adam& adam, const Tensor& targets,
                 std::size_t i_build, std::size_t epoch) const {
    const Tensor order =
        index_of(networks::epoch_order(seed_, i_build, epoch, train_rows_.size(), settings_.epoch_records));
    for (std::int64_t first = 0; first < order.size(0); first += settings_.batch_size) {
      const Tensor rows =
          order.slice(0, first, std::min<std::int64_t>(first + settings_.batch_size, order.size(0)));
      adam.zero_grad();
      ::torch::mse_loss(network->forward(train_.inputs.index_select(0, rows)), targets.index_select(0, rows))
          .backward();
      adam.step();
    }
  }

  static std::vector<Tensor> copy_of(nn::Sequential& network) {
    std::vector<Tensor> copy;
    for (const auto& parameter : network->parameters()) copy.push_back(parameter.detach().clone());
    return copy;
  }

  static void restore(nn::Sequential& network, const std::vector<Tensor>& from) {
    const ::torch::NoGradGuard no_gradient;
    const auto parameters = network->parameters();
    for (std::size_t i = 0; i < from.size(); ++i) Tensor(parameters[i]).copy_(from[i]);
  }

  const networks::ScreenSettings& settings_;
  base::Seed seed_;
  std::vector<std::uint32_t> train_rows_;
  Tensor inputs_, targets_;
  Records train_, validation_, test_;
};

}  // namespace

std::vector<double> SequentialScreening::column_error() const {
  const Eigen::RowVectorXd mean = build_error.colwise().mean();
  return {mean.data(), mean.data() + mean.size()};
}

SequentialScreening screen_sequentially(const networks::ScreeningData& data,
                                        const networks::ScreenSettings& settings, base::Seed seed,
                                        std::span<const std::uint32_t> columns) {
  const auto begin = std::chrono::steady_clock::now();
  Loop loop(data, settings, seed);
  SequentialScreening result;
  result.build_error.resize(settings.builds, static_cast<Eigen::Index>(columns.size()));
  for (Eigen::Index b = 0; b < settings.builds; ++b)
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto [error, epochs] = loop.build(static_cast<std::size_t>(b), columns[c]);
      result.build_error(b, static_cast<Eigen::Index>(c)) =
          std::isfinite(error) ? error : networks::largest_error;
      result.mean_epochs += epochs / static_cast<double>(result.build_error.size());
    }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return result;
}

}  // namespace elrom::benchmark
