#pragma once
// Cells of any shape as the eight corners of a hexahedron, some of which may coincide.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::ingest {

using Corners = std::array<std::int32_t, 8>;

/// From the cell's bottom, of three or four points, and the point above each of them: hexahedron, wedge,
/// pyramid or tetrahedron.
[[nodiscard]] Corners corners_of(std::span<const std::int32_t> bottom, std::span<const std::int32_t> top);

/// A hexahedron turned so that 0-1 runs along x, 0-3 along y and 0-4 along z as far as it can be; one that is
/// inside out is mended. Other shapes stay as they are. @param points [m], (n_points, 3)
[[nodiscard]] Corners upright(const Corners& corners, const MatrixD& points);

/// [m3], of either sense
[[nodiscard]] double volume_of(const Corners& corners, const MatrixD& points);

}  // namespace elrom::ingest
