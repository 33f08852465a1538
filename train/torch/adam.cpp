#include "adam.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace elrom::torch {
namespace {

constexpr float beta_mean = 0.9F, beta_square = 0.999F, epsilon = 1e-8F;

/// What a step multiplies with.
struct Factors {
  float decay;         ///< of the parameters
  float rate;          ///< learning rate over the mean's bias correction
  float square_scale;  ///< 1 / bias correction of the squares
};

void step_by_loops(float* parameters, const float* gradient, float* mean, float* square, std::int64_t n,
                   const Factors& f) {
  using Array = Eigen::Map<Eigen::ArrayXf>;
  constexpr std::int64_t chunk = 512;  // the five arrays' chunks stay in the first-level cache
  for (std::int64_t i = 0; i < n; i += chunk) {
    const std::int64_t size = std::min(chunk, n - i);
    const Eigen::Map<const Eigen::ArrayXf> g(gradient + i, size);
    Array p(parameters + i, size), m(mean + i, size), s(square + i, size);
    m = beta_mean * m + (1 - beta_mean) * g;
    s = beta_square * s + (1 - beta_square) * g.square();
    p = f.decay * p - f.rate * m / ((s * f.square_scale).sqrt() + epsilon);
  }
}

void step_by_operators(::torch::Tensor& parameters, const ::torch::Tensor& gradient, ::torch::Tensor& mean,
                       ::torch::Tensor& square, const Factors& f) {
  mean.mul_(beta_mean).add_(gradient, 1 - beta_mean);
  square.mul_(beta_square).addcmul_(gradient, gradient, 1 - beta_square);
  parameters.mul_(f.decay).addcdiv_(mean, (square * f.square_scale).sqrt_().add_(epsilon), -f.rate);
}

}  // namespace

void Adam::step(::torch::Tensor& parameters, const ::torch::Tensor& gradient, double learning_rate,
                double weight_decay) {
  ++n_steps_;
  const auto steps = static_cast<double>(n_steps_);
  const Factors factors{static_cast<float>(1 - learning_rate * weight_decay),
                        static_cast<float>(learning_rate / (1 - std::pow(double{beta_mean}, steps))),
                        static_cast<float>(1 / (1 - std::pow(double{beta_square}, steps)))};
  if (own_loops_)
    step_by_loops(parameters.data_ptr<float>(), gradient.data_ptr<float>(), mean_.data_ptr<float>(),
                  square_.data_ptr<float>(), parameters.numel(), factors);
  else
    step_by_operators(parameters, gradient, mean_, square_, factors);
}

void Adam::reset() {
  mean_.zero_();
  square_.zero_();
  n_steps_ = 0;
}

}  // namespace elrom::torch
