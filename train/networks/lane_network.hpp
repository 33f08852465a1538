#pragma once
// Sixteen one-output networks side by side, one a lane of a vector: the unit of work of the batched
// screening. Each network: y = v . relu(W x) + c with the hidden bias as the weight of a constant input.
// Lanes share the input, so the hidden layers of all networks are one wide product, and never exchange
// anything, so a network's bits depend neither on its neighbours nor on its place.
//
// Non-goals: more than one hidden layer, other activations (train/torch trains those).

#include <cstddef>
#include <span>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::networks {

inline constexpr std::size_t n_lanes = 16;
inline constexpr std::size_t tile = 4;  ///< rows, units and inputs are padded with zeros to multiples of this

struct alignas(64) Lane16 {
  float value[n_lanes] = {};
};
using LaneBuffer = std::vector<Lane16>;

/// Sizes of one network, padded.
struct LaneShape {
  std::size_t n_inputs = 0, n_units = 0;  //!< as asked
  std::size_t k = 0, u = 0;               //!< padded: inputs and the constant; units

  LaneShape(std::size_t n_inputs, std::size_t n_units);
  [[nodiscard]] std::size_t n_parameters() const { return k * u + u + 1; }  //!< W (k, u), v (u), c
};

/// One network by itself: flat parameters in the lane order, W (k, u), v (u), c.
using ColumnParameters = std::vector<float>;

/// Records as the lanes read them: (rows padded to `tile`, k),
/// the constant 1 after the inputs, zeros after it.
[[nodiscard]] MatrixF pad_inputs(const MatrixF& inputs, const LaneShape& shape);

/// @param x (n_rows, k), n_rows a multiple of `tile` @param activations (n_rows * u) @param y (n_rows)
void lanes_forward(const LaneShape& shape, const LaneBuffer& parameters, const float* x, std::size_t n_rows,
                   Lane16* activations, Lane16* y);

/// Gradient of sum_r error_r * y_r, as the chain rule from d loss / d y = error.
/// @param activations as forward left them; overwritten @param gradient in the order of the parameters
void lanes_backward(const LaneShape& shape, const LaneBuffer& parameters, const float* x, std::size_t n_rows,
                    Lane16* activations, const Lane16* error, LaneBuffer& gradient);

/// Adam (Kingma & Ba 2015), beta 0.9 / 0.999, eps 1e-8, without decay.
class LaneAdam {
 public:
  explicit LaneAdam(std::size_t n_parameters) : mean_(n_parameters), square_(n_parameters) {}
  /// @param i_step from 1
  void step(LaneBuffer& parameters, const LaneBuffer& gradient, double learning_rate, std::size_t i_step);
  /// Takes one lane's state over from another.
  void copy_lane(std::size_t lane, const LaneAdam& from, std::size_t from_lane);

 private:
  LaneBuffer mean_, square_;
};

void put_lane(LaneBuffer& buffer, std::size_t lane, const ColumnParameters& values);
[[nodiscard]] ColumnParameters get_lane(const LaneBuffer& buffer, std::size_t lane);
void copy_lane(LaneBuffer& to, std::size_t lane, const LaneBuffer& from, std::size_t from_lane);

}  // namespace elrom::networks
