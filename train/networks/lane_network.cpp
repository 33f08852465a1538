#include "lane_network.hpp"

#include <cmath>

namespace elrom::networks {
namespace {

// Sixteen floats as the compiler's own vector: one register
// with AVX-512, two with AVX2, plain code elsewhere.
typedef float Vector __attribute__((vector_size(64), may_alias));

const Vector* vectors(const Lane16* lanes) { return reinterpret_cast<const Vector*>(lanes); }
Vector* vectors(Lane16* lanes) { return reinterpret_cast<Vector*>(lanes); }

constexpr std::size_t padded(std::size_t n) { return (n + tile - 1) / tile * tile; }

// sum[i][j] = sum_k left[i * left_stride_i + k * left_stride_k] * right[k * right_stride + j]: a 4 x 4 tile
// held in registers, the core of both products.
inline void multiply_tile(const float* left, std::size_t left_stride_i, std::size_t left_stride_k,
                          const Vector* right, std::size_t right_stride, std::size_t n,
                          Vector (&sum)[tile][tile]) {
  for (auto& row : sum)
    for (auto& value : row) value = Vector{};
  for (std::size_t k = 0; k < n; ++k, right += right_stride, left += left_stride_k) {
    const Vector r0 = right[0], r1 = right[1], r2 = right[2], r3 = right[3];
#pragma GCC unroll 4
    for (std::size_t i = 0; i < tile; ++i) {
      const float l = left[i * left_stride_i];
      sum[i][0] += l * r0;
      sum[i][1] += l * r1;
      sum[i][2] += l * r2;
      sum[i][3] += l * r3;
    }
  }
}

// activations <- (activation > 0) * error, the gradient at the hidden units but for v; returns sum_r error *
// activation in v_gradient.
void gate(std::size_t n_rows, std::size_t u, Vector* activations, const Vector* error, Vector* v_gradient) {
  const Vector zero{};
  for (std::size_t j = 0; j < u; ++j) v_gradient[j] = zero;
  for (std::size_t r = 0; r < n_rows; ++r) {
    Vector* row = activations + r * u;
    const Vector e = error[r];
    for (std::size_t j = 0; j < u; ++j) {
      const Vector a = row[j];
      v_gradient[j] += e * a;
      row[j] = a > zero ? e : zero;
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
  const Vector *w = vectors(parameters.data()), *v = w + k * u, *c = v + u;
  const Vector zero{};
  for (std::size_t r = 0; r < n_rows; r += tile) {
    Vector output[tile] = {*c, *c, *c, *c};
    for (std::size_t j = 0; j < u; j += tile) {
      Vector sum[tile][tile];
      multiply_tile(x + r * k, k, 1, w + j, u, k, sum);
#pragma GCC unroll 4
      for (std::size_t i = 0; i < tile; ++i) {
#pragma GCC unroll 4
        for (std::size_t m = 0; m < tile; ++m) {
          const Vector a = sum[i][m] > zero ? sum[i][m] : zero;
          vectors(activations)[(r + i) * u + j + m] = a;
          output[i] += a * v[j + m];
        }
      }
    }
    for (std::size_t i = 0; i < tile; ++i) vectors(y)[r + i] = output[i];
  }
}

void lanes_backward(const LaneShape& shape, const LaneBuffer& parameters, const float* x, std::size_t n_rows,
                    Lane16* activations, const Lane16* error, LaneBuffer& gradient) {
  const std::size_t k = shape.k, u = shape.u;
  const Vector* v = vectors(parameters.data()) + k * u;
  Vector *w_gradient = vectors(gradient.data()), *v_gradient = w_gradient + k * u,
         *c_gradient = v_gradient + u;
  gate(n_rows, u, vectors(activations), vectors(error), v_gradient);
  *c_gradient = Vector{};
  for (std::size_t r = 0; r < n_rows; ++r) *c_gradient += vectors(error)[r];
  for (std::size_t i_k = 0; i_k < k; i_k += tile) {
    for (std::size_t j = 0; j < u; j += tile) {
      Vector sum[tile][tile];
      multiply_tile(x + i_k, 1, k, vectors(activations) + j, u, n_rows, sum);
#pragma GCC unroll 4
      for (std::size_t i = 0; i < tile; ++i) {
#pragma GCC unroll 4
        for (std::size_t m = 0; m < tile; ++m) w_gradient[(i_k + i) * u + j + m] = sum[i][m] * v[j + m];
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
