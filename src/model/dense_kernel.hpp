#pragma once
// One fully connected layer on transposed rows: features lie along the first axis, the rows of a batch along
// the second, padded to a whole number of `lane` floats. Weights are read once, in the order in which a
// bundle keeps them, so nothing is packed; vectors run over the rows.
//
// Every output is start + w_0 x_0 + w_1 x_1 + ... added in that order in one register, whatever the number of
// rows is and wherever a row stands: results do not depend on the other rows, to the bit.

#include <cstddef>

#include "elrom/io/tensor_file.hpp"
#include "elrom/model/network.hpp"

namespace elrom::model {

/// Rows are padded to a multiple of this, and memory is aligned to it.
inline constexpr std::size_t lane = 16;
/// Rows of one pass, whose activations stay in the second-level cache: 66 planes of the furnace are one.
inline constexpr std::size_t block_rows = 5 * lane;
[[nodiscard]] constexpr std::size_t padded(std::size_t n_rows) { return (n_rows + lane - 1) / lane * lane; }

/// Rows of a layer's weights, float32 or float16, with a leading dimension: a view of some of their columns.
struct WeightView {
  const io::Tensor* tensor = nullptr;
  std::size_t first_column = 0, n_columns = 0;
};

/// out(o, r) = start(o) + sum_k weights(o, k) in(k, r)
/// @param in (weights.n_columns, stride), 64-byte aligned @param start (n_out) @param out (n_out, stride)
void dense(const WeightView& weights, const float* in, std::size_t stride, const float* start, float* out,
           Workspace& workspace);

/// In place on `n` floats (a multiple of `lane`, 64-byte aligned).
void activate(Activation activation, float* values, std::size_t n);

}  // namespace elrom::model
