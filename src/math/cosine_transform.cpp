#include "elrom/math/cosine_transform.hpp"

#include <cmath>
#include <numbers>

#include "elrom/base/error.hpp"

namespace elrom::math {

MatrixF cosine_matrix(std::size_t n, Beyond beyond) {
  const double half = beyond == Beyond::negative ? 0.5 : 0;
  const auto size = static_cast<Eigen::Index>(n);
  MatrixF c(size, size);
  for (Eigen::Index k = 0; k < size; ++k) {
    const double wave = static_cast<double>(k) + half;
    const double scale = std::sqrt((wave == 0 ? 1.0 : 2.0) / static_cast<double>(n));
    for (Eigen::Index i = 0; i < size; ++i) {
      const double angle = std::numbers::pi * (static_cast<double>(i) + 0.5) * wave / static_cast<double>(n);
      c(k, i) = static_cast<float>(scale * std::cos(angle));
    }
  }
  return c;
}

CosineTransform::CosineTransform(std::array<std::size_t, 3> sizes, std::array<Beyond, 3> beyond)
    : sizes_(sizes) {
  for (std::size_t axis = 0; axis < 3; ++axis) matrices_[axis] = cosine_matrix(sizes[axis], beyond[axis]);
}

namespace {

/// Applies a matrix (or its transpose) along each axis in turn.
template <class Get>
void apply(const std::array<std::size_t, 3>& sizes, std::span<float> values, const Get& matrix) {
  const auto nz = static_cast<Eigen::Index>(sizes[0]), ny = static_cast<Eigen::Index>(sizes[1]),
             nx = static_cast<Eigen::Index>(sizes[2]);
  check(static_cast<Eigen::Index>(values.size()) == nz * ny * nx, "cosine transform: size of the box");
  MapF lines(values.data(), nz * ny, nx);
  lines = lines * matrix(2).transpose();
  for (Eigen::Index z = 0; z < nz; ++z) {
    MapF plane(values.data() + z * ny * nx, ny, nx);
    plane = matrix(1) * plane;
  }
  MapF planes(values.data(), nz, ny * nx);
  planes = matrix(0) * planes;
}

}  // namespace

void CosineTransform::forward(std::span<float> values) const {
  apply(sizes_, values, [&](std::size_t axis) -> const MatrixF& { return matrices_[axis]; });
}

void CosineTransform::backward(std::span<float> values) const {
  apply(sizes_, values, [&](std::size_t axis) -> MatrixF { return matrices_[axis].transpose(); });
}

}  // namespace elrom::math
