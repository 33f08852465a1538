#pragma once
// Networks with random weights, for tests of what is done with networks.

#include <cmath>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/model/network.hpp"

namespace elrom::test {

/// @param widths inputs, hidden layers ..., outputs
inline model::Network random_network(const std::vector<std::size_t>& widths, model::Activation activation,
                                     base::Seed seed) {
  base::Random random(seed);
  std::vector<model::Layer> layers;
  for (std::size_t i = 1; i < widths.size(); ++i) {
    const double bound = std::sqrt(3.0 / static_cast<double>(widths[i - 1]));
    std::vector<float> weights(widths[i] * widths[i - 1]), bias(widths[i]);
    for (auto& w : weights) w = static_cast<float>(random.uniform(-bound, bound));
    for (auto& b : bias) b = static_cast<float>(random.uniform(-0.5, 0.5));
    layers.push_back({io::Tensor::copy(std::span<const float>(weights), {widths[i], widths[i - 1]}),
                      io::Tensor::copy(std::span<const float>(bias), {widths[i]})});
  }
  return {std::move(layers), activation};
}

inline MatrixF random_matrix(Eigen::Index rows, Eigen::Index columns, base::Seed seed) {
  base::Random random(seed);
  MatrixF matrix(rows, columns);
  for (Eigen::Index i = 0; i < matrix.size(); ++i) matrix.data()[i] = static_cast<float>(random.normal());
  return matrix;
}

}  // namespace elrom::test
