#include "dense_kernel.hpp"

#include <algorithm>
#include <cstring>

namespace elrom::model {
namespace {

// Register tile for the instruction set: n_vectors of rows
// times n_outputs accumulators, with room for the operands.
#if defined(__AVX512F__)
constexpr std::size_t vector_floats = 16;
constexpr int n_vectors = 5, n_outputs = 4;
#elif defined(__AVX__)
constexpr std::size_t vector_floats = 8;
constexpr int n_vectors = 2, n_outputs = 4;
#else
constexpr std::size_t vector_floats = 4;
constexpr int n_vectors = 2, n_outputs = 4;
#endif
static_assert(lane % vector_floats == 0);

typedef float Vector __attribute__((vector_size(vector_floats * sizeof(float))));

struct Panel {
  const float* weights;  //!< (n_outputs, n_in), rows `weight_stride` apart
  std::size_t weight_stride, n_in;
  const float* in;
  std::size_t stride;
  const float* start;
  float* out;
};

template <int Outputs, int Vectors>
void multiply(const Panel& p, std::size_t first_row) {
  Vector sum[Outputs][Vectors];
  for (int o = 0; o < Outputs; ++o)
    for (int v = 0; v < Vectors; ++v) sum[o][v] = Vector{} + p.start[o];
  const float* in = p.in + first_row;
  for (std::size_t k = 0; k < p.n_in; ++k, in += p.stride) {
    const Vector* x = reinterpret_cast<const Vector*>(in);
    for (int o = 0; o < Outputs; ++o) {
      const float w = p.weights[static_cast<std::size_t>(o) * p.weight_stride + k];
      for (int v = 0; v < Vectors; ++v) sum[o][v] += w * x[v];
    }
  }
  for (int o = 0; o < Outputs; ++o) {
    float* out = p.out + static_cast<std::size_t>(o) * p.stride + first_row;
    for (int v = 0; v < Vectors; ++v) reinterpret_cast<Vector*>(out)[v] = sum[o][v];
  }
}

template <int Outputs, int Vectors>
void multiply_rest(const Panel& p, std::size_t first_row, int vectors) {
  if constexpr (Vectors > 0) {
    if (vectors == Vectors)
      multiply<Outputs, Vectors>(p, first_row);
    else
      multiply_rest<Outputs, Vectors - 1>(p, first_row, vectors);
  }
}

template <int Outputs>
void multiply_rows(const Panel& p) {
  constexpr std::size_t step = n_vectors * vector_floats;
  std::size_t row = 0;
  for (; row + step <= p.stride; row += step) multiply<Outputs, n_vectors>(p, row);
  multiply_rest<Outputs, n_vectors - 1>(p, row, static_cast<int>((p.stride - row) / vector_floats));
}

template <int Outputs>
void multiply_outputs(const Panel& p, int outputs) {
  if constexpr (Outputs > 0) {
    if (outputs == Outputs)
      multiply_rows<Outputs>(p);
    else
      multiply_outputs<Outputs - 1>(p, outputs);
  }
}

/// Weights of some outputs as float32: where they lie, or widened into `buffer`.
const float* weight_rows(const WeightView& view, std::size_t first, std::size_t count, float* buffer) {
  const auto& tensor = *view.tensor;
  const std::size_t row_size = tensor.shape()[1];
  const std::size_t offset = first * row_size + view.first_column;
  if (tensor.type() == io::DType::f32) return tensor.f32().data() + offset;
  const auto* halves = reinterpret_cast<const Eigen::half*>(tensor.bytes().data()) + offset;
  for (std::size_t o = 0; o < count; ++o)
    Eigen::Map<Eigen::ArrayXf>(buffer + o * view.n_columns, static_cast<Eigen::Index>(view.n_columns)) =
        Eigen::Map<const Eigen::Array<Eigen::half, Eigen::Dynamic, 1>>(
            halves + o * row_size, static_cast<Eigen::Index>(view.n_columns))
            .cast<float>();
  return buffer;
}

}  // namespace

void dense(const WeightView& weights, const float* in, std::size_t stride, const float* start, float* out,
           Workspace& workspace) {
  const bool widened = weights.tensor->type() != io::DType::f32;
  const std::size_t n_out = weights.tensor->shape()[0];
  const Workspace::Frame frame(workspace);
  float* buffer = widened ? workspace.floats(weights.n_columns * n_outputs).data() : nullptr;
  for (std::size_t o = 0; o < n_out; o += n_outputs) {
    const std::size_t count = std::min<std::size_t>(n_outputs, n_out - o);
    const Panel panel{weight_rows(weights, o, count, buffer),
                      widened ? weights.n_columns : weights.tensor->shape()[1],
                      weights.n_columns,
                      in,
                      stride,
                      start + o,
                      out + o * stride};
    multiply_outputs<n_outputs>(panel, static_cast<int>(count));
  }
}

void activate(Activation activation, float* values, std::size_t n) {
  // Arrays of a fixed size: Eigen then uses its vector functions for every element, never a scalar remainder.
  using Chunk = Eigen::Map<Eigen::Array<float, lane, 1>, Eigen::Aligned64>;
  for (std::size_t i = 0; i < n; i += lane) {
    Chunk x(values + i);
    switch (activation) {
      case Activation::relu:
        x = x.max(0.0F);
        break;
      case Activation::tanh:
        x = x.tanh();
        break;
      case Activation::silu:
        x = x / (1.0F + (-x).exp());
        break;
    }
  }
}

}  // namespace elrom::model
