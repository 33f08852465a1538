#pragma once
// Orthonormal discrete cosine transform (DCT-II) of values on a box of cells; sizes are small, so dense
// matrices do it.

#include <array>
#include <span>

#include "elrom/math/matrix.hpp"

namespace elrom::math {

/// C(k, i) = s_k cos(pi (i + 1/2) k / n), s_0 = sqrt(1/n), else sqrt(2/n); C C^T = I. (n, n)
[[nodiscard]] MatrixF cosine_matrix(std::size_t n);

/// Transform of a box stored with the last axis fastest. Thread rule: const use from any thread.
class CosineTransform {
 public:
  explicit CosineTransform(std::array<std::size_t, 3> sizes);
  [[nodiscard]] const std::array<std::size_t, 3>& sizes() const { return sizes_; }
  /// In place, (sizes[0] * sizes[1] * sizes[2]).
  void forward(std::span<float> values) const;
  /// Undoes forward().
  void backward(std::span<float> values) const;

 private:
  std::array<std::size_t, 3> sizes_;
  std::array<MatrixF, 3> matrices_;
};

}  // namespace elrom::math
