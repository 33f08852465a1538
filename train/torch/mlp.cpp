#include "mlp.hpp"

#include <cmath>

#include "elrom/base/error.hpp"

namespace elrom::torch {
namespace {

using ::torch::Tensor;

std::int64_t n_parameters(const std::vector<std::int64_t>& widths) {
  std::int64_t n = 0;
  for (std::size_t i = 1; i < widths.size(); ++i) n += widths[i] * (widths[i - 1] + 1);
  return n;
}

}  // namespace

Mlp::Mlp(std::vector<std::int64_t> widths, model::Activation activation, ::torch::Device device)
    : widths_(std::move(widths)), activation_(activation) {
  const auto options = ::torch::TensorOptions().dtype(::torch::kFloat32).device(device);
  parameters_ = ::torch::zeros({n_parameters(widths_)}, options);
  gradient_ = ::torch::zeros_like(parameters_);
  layers_ = views_of(parameters_);
  gradients_ = views_of(gradient_);
}

std::vector<Mlp::LayerViews> Mlp::views_of(const Tensor& flat) const {
  std::vector<LayerViews> views;
  std::int64_t at = 0;
  for (std::size_t i = 1; i < widths_.size(); ++i) {
    const std::int64_t n_in = widths_[i - 1], n_out = widths_[i];
    const Tensor weights = flat.narrow(0, at, n_out * n_in).view({n_out, n_in});
    at += n_out * n_in;
    views.push_back({weights, weights.t(), flat.narrow(0, at, n_out)});
    at += n_out;
  }
  return views;
}

void Mlp::initialise(base::Seed seed) {
  base::Random random(seed);
  Tensor values = ::torch::empty({parameters_.numel()}, ::torch::kFloat32);
  float* value = values.data_ptr<float>();
  for (std::size_t i = 1; i < widths_.size(); ++i) {
    const double bound = 1 / std::sqrt(static_cast<double>(widths_[i - 1]));
    for (std::int64_t k = 0; k < widths_[i] * (widths_[i - 1] + 1); ++k)
      *value++ = static_cast<float>(random.uniform(-bound, bound));
  }
  parameters_.copy_(values);
}

void Mlp::begin_at(std::span<const float> parameters) {
  const auto n = static_cast<std::int64_t>(parameters.size());
  check(n == parameters_.numel(), "first weights of a network of another shape");
  parameters_.copy_(::torch::from_blob(const_cast<float*>(parameters.data()), {n}, ::torch::kFloat32));
}

Pass Mlp::make_pass(std::int64_t n_rows, bool weighted, bool training, bool dropout) const {
  const auto make = [&](std::int64_t width) {
    return ::torch::zeros({n_rows, width}, parameters_.options());
  };
  Pass pass;
  pass.n_rows = n_rows;
  pass.x = make(widths_.front());
  pass.target = make(widths_.back());
  pass.y = make(widths_.back());
  pass.error = make(widths_.back());
  if (weighted) pass.weight = make(widths_.back());
  for (std::size_t i = 1; i + 1 < widths_.size(); ++i) {
    pass.active.push_back(make(widths_[i]));
    pass.before.push_back(activation_ == model::Activation::silu ? make(widths_[i]) : pass.active.back());
    pass.dropped.push_back(dropout ? make(widths_[i]) : pass.active.back());
    if (dropout) pass.kept.push_back(make(widths_[i]));
    if (training) pass.slope.push_back(make(widths_[i]));
  }
  return pass;
}

void Mlp::draw_dropout(Pass& pass, double rate, base::Random& random) {
  const auto scale = static_cast<float>(1 / (1 - rate));
  for (auto& kept : pass.kept) {
    Tensor factors = kept.is_cpu() ? kept : ::torch::empty(kept.sizes(), ::torch::kFloat32);
    float* value = factors.data_ptr<float>();
    for (std::int64_t k = 0; k < factors.numel(); ++k) value[k] = random.uniform() < rate ? 0.0F : scale;
    if (!kept.is_cpu()) kept.copy_(factors);
  }
}

void Mlp::activate(Pass& pass, std::size_t i_layer) const {
  Tensor &before = pass.before[i_layer], &active = pass.active[i_layer];
  switch (activation_) {
    case model::Activation::relu:
      at::clamp_min_out(active, before, 0);
      break;
    case model::Activation::tanh:
      at::tanh_out(active, before);
      break;
    case model::Activation::silu:
      at::silu_out(active, before);
      break;
  }
  if (!pass.kept.empty()) at::mul_out(pass.dropped[i_layer], active, pass.kept[i_layer]);
}

void Mlp::activation_slope(Pass& pass, std::size_t i_layer) const {
  Tensor& slope = pass.slope[i_layer];
  if (!pass.kept.empty()) slope.mul_(pass.kept[i_layer]);
  switch (activation_) {
    case model::Activation::relu:
      at::threshold_backward_out(slope, slope, pass.active[i_layer], 0);
      break;
    case model::Activation::tanh:
      at::tanh_backward_out(slope, slope, pass.active[i_layer]);
      break;
    case model::Activation::silu:
      at::silu_backward_out(slope, slope, pass.before[i_layer]);
      break;
  }
}

void Mlp::forward(Pass& pass) const {
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    const Tensor& in = i == 0 ? pass.x : pass.dropped[i - 1];
    const bool last = i + 1 == layers_.size();
    at::addmm_out(last ? pass.y : pass.before[i], layers_[i].bias, in, layers_[i].weights_t);
    if (!last) activate(pass, i);
  }
}

void Mlp::backward(Pass& pass) {
  for (std::size_t i = layers_.size(); i-- > 0;) {
    const Tensor& slope = i + 1 == layers_.size() ? pass.error : pass.slope[i];
    const Tensor& in = i == 0 ? pass.x : pass.dropped[i - 1];
    at::mm_out(gradients_[i].weights, slope.t(), in);
    at::sum_out(gradients_[i].bias, slope, {0});
    if (i == 0) continue;
    at::mm_out(pass.slope[i - 1], slope, layers_[i].weights);
    activation_slope(pass, i - 1);
  }
}

model::Network Mlp::network(const Tensor& parameters) const {
  const Tensor host = parameters.to(::torch::kCPU).contiguous();
  std::vector<model::Layer> layers;
  for (const auto& view : views_of(host)) {
    const auto n_out = static_cast<std::size_t>(view.weights.size(0)),
               n_in = static_cast<std::size_t>(view.weights.size(1));
    layers.push_back(
        {io::Tensor::copy(std::span(view.weights.data_ptr<float>(), n_out * n_in), {n_out, n_in}),
         io::Tensor::copy(std::span(view.bias.data_ptr<float>(), n_out), {n_out})});
  }
  return {std::move(layers), activation_};
}

}  // namespace elrom::torch
