#pragma once
// Adam with decoupled weight decay on one flat parameter tensor (Kingma & Ba 2015, algorithm 1; Loshchilov &
// Hutter 2019, algorithm 2): beta 0.9 and 0.999, epsilon 1e-8. Loops of our own take one sweep over memory.

#include <torch/types.h>

#include <cstdint>

namespace elrom::torch {

class Adam {
 public:
  /// @param own_loops see Place
  Adam(const ::torch::Tensor& parameters, bool own_loops)
      : mean_(::torch::zeros_like(parameters)),
        square_(::torch::zeros_like(parameters)),
        own_loops_(own_loops) {}

  void step(::torch::Tensor& parameters, const ::torch::Tensor& gradient, double learning_rate,
            double weight_decay);
  void reset();

  [[nodiscard]] ::torch::Tensor& mean() { return mean_; }
  [[nodiscard]] ::torch::Tensor& square() { return square_; }
  [[nodiscard]] std::int64_t n_steps() const { return n_steps_; }
  void set_n_steps(std::int64_t n_steps) { n_steps_ = n_steps; }

 private:
  ::torch::Tensor mean_, square_;
  bool own_loops_;
  std::int64_t n_steps_ = 0;
};

}  // namespace elrom::torch
