#pragma once
// A multilayer perceptron with its gradient, written with LibTorch's in-place products: no graph is recorded,
// and a step allocates nothing. Parameters lie in one flat tensor: weights (n_out, n_in) then bias (n_out),
// layer after layer.

#include <torch/types.h>

#include <cstdint>
#include <span>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/model/network.hpp"
#include "elrom/networks/trainer.hpp"

namespace elrom::torch {

/// Where tensors lie, and who works on them beside the products: loops of our own, faster on a CPU, or
/// LibTorch's operators, which a GPU needs (on the CPU they are there to be tested).
struct Place {
  ::torch::Device device = ::torch::kCPU;
  bool own_loops = device.is_cpu();
};

/// The buffers of one pass of a fixed number of rows.
struct Pass {
  std::int64_t n_rows = 0;
  ::torch::Tensor x, target, weight;  //!< (n_rows, n_in), (n_rows, n_out), (n_rows, n_out) or undefined
  //! Of each hidden layer before the activation: silu needs it, (n_rows, width)
  std::vector<::torch::Tensor> before;
  std::vector<::torch::Tensor> active;   //!< after it
  std::vector<::torch::Tensor> dropped;  //!< after dropout (the same tensor without dropout)
  std::vector<::torch::Tensor> kept;     //!< dropout's factors, 0 or 1 / (1 - p); empty without dropout
  std::vector<::torch::Tensor> slope;    //!< loss by each hidden layer's output
  ::torch::Tensor y, error;              //!< (n_rows, n_out)
};

class Mlp {
 public:
  /// @param widths inputs, hidden layers ..., outputs
  Mlp(std::vector<std::int64_t> widths, model::Activation activation, ::torch::Device device);

  /// Uniform in +-1 / sqrt(n_in of the layer), weights and biases
  /// alike (LibTorch's own default for linear layers).
  void initialise(base::Seed seed);
  /// @param parameters in their order, (number of parameters())
  void begin_at(std::span<const float> parameters);
  [[nodiscard]] ::torch::Tensor& parameters() { return parameters_; }
  [[nodiscard]] ::torch::Tensor& gradient() { return gradient_; }
  [[nodiscard]] const std::vector<std::int64_t>& widths() const { return widths_; }

  /// @param training buffers for backward() too, and for dropout when it is > 0
  [[nodiscard]] Pass make_pass(std::int64_t n_rows, bool weighted, bool training, bool dropout) const;
  /// Draws the factors of this step's dropout.
  static void draw_dropout(Pass& pass, double rate, base::Random& random);
  /// pass.x to pass.y
  void forward(Pass& pass) const;
  /// pass.error = loss by pass.y; fills gradient()
  void backward(Pass& pass);

  /// The flat parameters as a network.
  [[nodiscard]] model::Network network(const ::torch::Tensor& parameters) const;

 private:
  struct LayerViews {
    ::torch::Tensor weights, weights_t, bias;
  };
  [[nodiscard]] std::vector<LayerViews> views_of(const ::torch::Tensor& flat) const;
  void activate(Pass& pass, std::size_t i_layer) const;
  void activation_slope(Pass& pass, std::size_t i_layer) const;

  std::vector<std::int64_t> widths_;
  model::Activation activation_;
  ::torch::Tensor parameters_, gradient_;
  std::vector<LayerViews> layers_, gradients_;
};

}  // namespace elrom::torch
