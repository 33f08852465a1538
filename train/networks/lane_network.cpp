#include "lane_network.hpp"

#include <cmath>

namespace elrom::networks {
namespace {

// Register tile for the instruction set: `tile` rows times n_units accumulators, with room for the operands.
// Wider vectors than the processor's would be taken apart through memory, at a tenth of the speed.
#if defined(__AVX512F__)
constexpr std::size_t vector_floats = 16, n_units = 4;
#elif defined(__AVX__)
constexpr std::size_t vector_floats = 8, n_units = 2;
#else
constexpr std::size_t vector_floats = 4, n_units = 2;
#endif
constexpr std::size_t n_parts = n_lanes / vector_floats;  // vectors of a Lane16
static_assert(n_lanes % vector_floats == 0 && tile % n_units == 0);

typedef float Vector __attribute__((vector_size(vector_floats * sizeof(float)), may_alias));

const Vector* vectors(const Lane16* lanes) { return reinterpret_cast<const Vector*>(lanes); }
Vector* vectors(Lane16* lanes) { return reinterpret_cast<Vector*>(lanes); }

constexpr std::size_t padded(std::size_t n) { return (n + tile - 1) / tile * tile; }

// sum[i][m] = sum_k left[i * left_stride_i + k * left_stride_k] * right[k * right_stride + m], of one part of
// the lanes: held in registers, the core of both products.
inline void multiply_tile(const float* left, std::size_t left_stride_i, std::size_t left_stride_k,
                          const Vector* right, std::size_t right_stride, std::size_t n,
                          Vector (&sum)[tile][n_units]) {
  for (auto& row : sum)
    for (auto& value : row) value = Vector{};
  for (std::size_t k = 0; k < n; ++k, right += right_stride * n_parts, left += left_stride_k) {
#pragma GCC unroll 4
    for (std::size_t i = 0; i < tile; ++i) {
      const float l = left[i * left_stride_i];
#pragma GCC unroll 4
      for (std::size_t m = 0; m < n_units; ++m) sum[i][m] += l * right[m * n_parts];
    }
  }
}

// activations <- (activation > 0) * error, the gradient at the hidden units but for v; returns sum_r error *
// activation in v_gradient. One part of the lanes.
void gate(std::size_t n_rows, std::size_t u, Vector* activations, const Vector* error, Vector* v_gradient) {
  const Vector zero{};
  for (std::size_t j = 0; j < u; ++j) v_gradient[j * n_parts] = zero;
  for (std::size_t r = 0; r < n_rows; ++r) {
    Vector* row = activations + r * u * n_parts;
    const Vector e = error[r * n_parts];
    for (std::size_t j = 0; j < u; ++j) {
      Vector& a = row[j * n_parts];
      v_gradient[j * n_parts] += e * a;
      a = a > zero ? e : zero;
    }
  }
}

Eigen::Map<Eigen::ArrayXf> flat(LaneBuffer& buffer) {
  return {buffer.data()->value, static_cast<Eigen::Index>(buffer.size() * n_lanes)};
}
Eigen::Map<const Eigen::ArrayXf> flat(const LaneBuffer& buffer) {
  return {buffer.data()->value, static_cast<Eigen::Index>(buffer.size() * n_lanes)};
}

}  // namespace

LaneShape::LaneShape(std::size_t n_inputs_, std::size_t n_units_)
    : n_inputs(n_inputs_), n_units(n_units_), k(padded(n_inputs_ + 1)), u(padded(n_units_)) {}

MatrixF pad_inputs(const MatrixF& inputs, const LaneShape& shape) {
  const auto n = inputs.rows(), n_inputs = inputs.cols();
  MatrixF x = MatrixF::Zero(static_cast<Eigen::Index>(padded(static_cast<std::size_t>(n))),
                            static_cast<Eigen::Index>(shape.k));
  x.topLeftCorner(n, n_inputs) = inputs;
  x.block(0, n_inputs, n, 1).setOnes();
  return x;
}

void lanes_forward(const LaneShape& shape, const LaneBuffer& parameters, const float* x, std::size_t n_rows,
                   Lane16* activations, Lane16* y) {
  const std::size_t k = shape.k, u = shape.u;
  const Vector zero{};
  for (std::size_t part = 0; part < n_parts; ++part) {
    const Vector *w = vectors(parameters.data()) + part, *v = w + k * u * n_parts, *c = v + u * n_parts;
    Vector *hidden = vectors(activations) + part, *out = vectors(y) + part;
    for (std::size_t r = 0; r < n_rows; r += tile) {
      Vector output[tile] = {*c, *c, *c, *c};
      for (std::size_t j = 0; j < u; j += n_units) {
        Vector sum[tile][n_units];
        multiply_tile(x + r * k, k, 1, w + j * n_parts, u, k, sum);
#pragma GCC unroll 4
        for (std::size_t i = 0; i < tile; ++i) {
#pragma GCC unroll 4
          for (std::size_t m = 0; m < n_units; ++m) {
            const Vector a = sum[i][m] > zero ? sum[i][m] : zero;
            hidden[((r + i) * u + j + m) * n_parts] = a;
            output[i] += a * v[(j + m) * n_parts];
          }
        }
      }
      for (std::size_t i = 0; i < tile; ++i) out[(r + i) * n_parts] = output[i];
    }
  }
}

void lanes_backward(const LaneShape& shape, const LaneBuffer& parameters, const float* x, std::size_t n_rows,
                    Lane16* activations, const Lane16* error, LaneBuffer& gradient) {
  const std::size_t k = shape.k, u = shape.u;
  for (std::size_t part = 0; part < n_parts; ++part) {
    const Vector *v = vectors(parameters.data()) + k * u * n_parts + part, *e = vectors(error) + part;
    Vector *w_gradient = vectors(gradient.data()) + part, *v_gradient = w_gradient + k * u * n_parts,
           *c_gradient = v_gradient + u * n_parts, *hidden = vectors(activations) + part;
    gate(n_rows, u, hidden, e, v_gradient);
    *c_gradient = Vector{};
    for (std::size_t r = 0; r < n_rows; ++r) *c_gradient += e[r * n_parts];
    for (std::size_t i_k = 0; i_k < k; i_k += tile) {
      for (std::size_t j = 0; j < u; j += n_units) {
        Vector sum[tile][n_units];
        multiply_tile(x + i_k, 1, k, hidden + j * n_parts, u, n_rows, sum);
#pragma GCC unroll 4
        for (std::size_t i = 0; i < tile; ++i) {
#pragma GCC unroll 4
          for (std::size_t m = 0; m < n_units; ++m)
            w_gradient[((i_k + i) * u + j + m) * n_parts] = sum[i][m] * v[(j + m) * n_parts];
        }
      }
    }
  }
}

void LaneAdam::step(LaneBuffer& parameters, const LaneBuffer& gradient, double learning_rate,
                    std::size_t i_step) {
  constexpr float beta1 = 0.9F, beta2 = 0.999F, eps = 1e-8F;
  const double t = static_cast<double>(i_step);
  const auto step = static_cast<float>(learning_rate / (1 - std::pow(0.9, t)));
  const auto scale = static_cast<float>(1 / std::sqrt(1 - std::pow(0.999, t)));
  auto m = flat(mean_), s = flat(square_), w = flat(parameters);
  const auto g = flat(gradient);
  m = beta1 * m + (1 - beta1) * g;
  s = beta2 * s + (1 - beta2) * g * g;
  w -= step * m / (s.sqrt() * scale + eps);
}

void LaneAdam::copy_lane(std::size_t lane, const LaneAdam& from, std::size_t from_lane) {
  networks::copy_lane(mean_, lane, from.mean_, from_lane);
  networks::copy_lane(square_, lane, from.square_, from_lane);
}

void put_lane(LaneBuffer& buffer, std::size_t lane, const ColumnParameters& values) {
  for (std::size_t p = 0; p < buffer.size(); ++p) buffer[p].value[lane] = values[p];
}

ColumnParameters get_lane(const LaneBuffer& buffer, std::size_t lane) {
  ColumnParameters values(buffer.size());
  for (std::size_t p = 0; p < buffer.size(); ++p) values[p] = buffer[p].value[lane];
  return values;
}

void copy_lane(LaneBuffer& to, std::size_t lane, const LaneBuffer& from, std::size_t from_lane) {
  for (std::size_t p = 0; p < to.size(); ++p) to[p].value[lane] = from[p].value[from_lane];
}

}  // namespace elrom::networks
