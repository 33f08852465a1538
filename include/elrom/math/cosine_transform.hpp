#pragma once
// Orthonormal discrete cosine transform of values on a box of cells; sizes are small, so dense matrices do
// it.

#include <array>
#include <span>

#include "elrom/math/matrix.hpp"

namespace elrom::math {

/// What the values do behind the last cell of an axis: go on as they are seen in a mirror there (DCT-II), or
/// as the negative of that (DCT-IV). Before the first cell they always go on as in a mirror.
enum class Beyond { same, negative };

/// C(k, i) = s_k cos(pi (i + 1/2) (k + h) / n), h = 0 and s_0 = sqrt(1/n), s_k = sqrt(2/n) for Beyond::same,
/// h = 1/2 and s_k = sqrt(2/n) for Beyond::negative; C C^T = I. (n, n)
[[nodiscard]] MatrixF cosine_matrix(std::size_t n, Beyond beyond = Beyond::same);

/// Transform of a box stored with the last axis fastest. Thread rule: const use from any thread.
class CosineTransform {
 public:
  explicit CosineTransform(std::array<std::size_t, 3> sizes, std::array<Beyond, 3> beyond = {});
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
