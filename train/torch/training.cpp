#include "training.hpp"

#include <ATen/Parallel.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "elrom/base/error.hpp"

namespace elrom::torch {
namespace {

using ::torch::Tensor;

constexpr std::int64_t evaluation_rows = 256;

std::vector<std::int64_t> widths_of(const networks::TrainingProblem& problem,
                                    const networks::Hyperparameters& h) {
  check(h.n_layers >= 0 && h.n_units > 0 && h.batch_size > 0, "sizes of a network and its batches");
  std::vector<std::int64_t> widths{problem.train_inputs.cols()};
  widths.insert(widths.end(), static_cast<std::size_t>(h.n_layers), h.n_units);
  widths.push_back(problem.train_targets.cols());
  return widths;
}

using ConstArray = Eigen::Map<const Eigen::ArrayXf>;

}  // namespace

OneFastThread::OneFastThread() {
  at::set_num_threads(1);
  at::globalContext().setFlushDenormal(true);
}

OneFastThread::~OneFastThread() { at::globalContext().setFlushDenormal(false); }

Training::Training(const networks::TrainingProblem& problem, const networks::Hyperparameters& hyperparameters,
                   base::Seed seed, Place place)
    : hyperparameters_(hyperparameters),
      seed_(seed),
      start_(problem.start),
      own_loops_(place.own_loops),
      train_(problem.train_inputs, problem.train_targets, problem.train_weights, place),
      validation_(problem.validation_inputs, problem.validation_targets, problem.validation_weights, place),
      mlp_(widths_of(problem, hyperparameters), hyperparameters.activation, place.device),
      adam_(mlp_.parameters(), place.own_loops),
      best_(::torch::zeros_like(mlp_.parameters())),
      sum_of_squares_(
          ::torch::zeros({1}, ::torch::TensorOptions().dtype(::torch::kFloat64).device(place.device))),
      order_(static_cast<std::size_t>(train_.size())),
      dropout_random_(seed) {
  check(train_.size() > 0, "records to train with");
  all_rows_.resize(static_cast<std::size_t>(std::max(train_.size(), validation_.size())));
  std::iota(all_rows_.begin(), all_rows_.end(), 0);
  restart(hyperparameters.learning_rate);
}

void Training::restart(double learning_rate) {
  if (start_.size() == 0)
    mlp_.initialise(seed_.derive("weights"));
  else
    mlp_.begin_at(std::span(start_.data(), static_cast<std::size_t>(start_.size())));
  best_.copy_(mlp_.parameters());
  adam_.reset();
  const double worst = std::numeric_limits<double>::max();
  progress_ = {0, learning_rate, progress_.backed_off, 0, worst, worst, {}};
}

Pass& Training::pass_of(std::int64_t n_rows) {
  const auto same = [&](const Pass& pass) { return pass.n_rows == n_rows; };
  const auto found = std::find_if(train_passes_.begin(), train_passes_.end(), same);
  if (found != train_passes_.end()) return *found;
  train_passes_.push_back(mlp_.make_pass(n_rows, train_.weighted(), true, hyperparameters_.dropout > 0));
  return train_passes_.back();
}

void Training::residual(Pass& pass, double scale) {
  if (!own_loops_) {
    at::sub_out(pass.error, pass.y, pass.target);
    if (pass.weight.defined()) pass.error.mul_(pass.weight);
    sum_of_squares_.add_(pass.error.square().sum(::torch::kFloat64));
    pass.error.mul_(scale);
    return;
  }
  const auto n = pass.y.numel();
  const ConstArray y(pass.y.data_ptr<float>(), n), target(pass.target.data_ptr<float>(), n);
  Eigen::Map<Eigen::ArrayXf> error(pass.error.data_ptr<float>(), n);
  if (pass.weight.defined())
    error = (y - target) * ConstArray(pass.weight.data_ptr<float>(), n);
  else
    error = y - target;
  *sum_of_squares_.data_ptr<double>() += static_cast<double>(error.square().sum());
  error *= static_cast<float>(scale);
}

double Training::take_sum() {
  const double sum = sum_of_squares_.item<double>();
  sum_of_squares_.zero_();
  return sum;
}

void Training::step(std::span<const std::int64_t> rows) {
  const double count = train_.n_targets(rows);
  if (count == 0) return;
  Pass& pass = pass_of(static_cast<std::int64_t>(rows.size()));
  train_.gather(rows, pass);
  if (hyperparameters_.dropout > 0) Mlp::draw_dropout(pass, hyperparameters_.dropout, dropout_random_);
  mlp_.forward(pass);
  residual(pass, 2 / count);
  mlp_.backward(pass);
  adam_.step(mlp_.parameters(), mlp_.gradient(), rate_factor_ * progress_.learning_rate,
             hyperparameters_.weight_decay);
}

double Training::evaluate() {
  const Records& records = validation_.size() > 0 ? validation_ : train_;
  for (std::int64_t first = 0; first < records.size(); first += evaluation_rows) {
    const std::int64_t n_rows = std::min(evaluation_rows, records.size() - first);
    const auto same = [&](const Pass& pass) { return pass.n_rows == n_rows; };
    auto pass = std::find_if(evaluation_passes_.begin(), evaluation_passes_.end(), same);
    if (pass == evaluation_passes_.end())
      pass = evaluation_passes_.insert(pass, mlp_.make_pass(n_rows, records.weighted(), false, false));
    records.gather(
        std::span(all_rows_).subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(n_rows)),
        *pass);
    mlp_.forward(*pass);
    residual(*pass, 1);
  }
  return take_sum() / std::max(1.0, records.n_targets());
}

std::span<const std::int64_t> Training::next_records(int most_records) {
  // Streams by sweep: a resumed training needs no generator's state.
  const auto part =
      networks::epoch_part(order_.size(), most_records, static_cast<std::size_t>(progress_.epoch));
  std::iota(order_.begin(), order_.end(), 0);
  base::Random(seed_.derive("order").derive(part.sweep)).shuffle(order_);
  return std::span(order_).subspan(part.first, part.size);
}

bool Training::run_epoch(int most_records, double rate_factor) {
  rate_factor_ = rate_factor;
  const auto records = next_records(most_records);
  dropout_random_ = base::Random(seed_.derive("dropout").derive(static_cast<std::uint64_t>(progress_.epoch)));
  const auto batch = static_cast<std::size_t>(hyperparameters_.batch_size);
  for (std::size_t first = 0; first < records.size(); first += batch)
    step(records.subspan(first, std::min(batch, records.size() - first)));
  const double train_mse = take_sum() / std::max(1.0, train_.n_targets(records));
  const double validation_mse = evaluate();
  ++progress_.epoch;
  progress_.history.push_back(validation_mse);
  if (!std::isfinite(train_mse) || !std::isfinite(validation_mse)) return false;
  if (validation_mse < progress_.best_validation) {
    progress_.best_validation = validation_mse;
    progress_.best_train = train_mse;
    progress_.best_epoch = progress_.epoch;
    best_.copy_(mlp_.parameters());
  }
  return true;
}

}  // namespace elrom::torch
