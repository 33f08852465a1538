#include "cell_shapes.hpp"

#include <algorithm>
#include <set>

#include "elrom/base/error.hpp"
#include "elrom/field/hexahedron.hpp"

namespace elrom::ingest {
namespace {

// Corner i of the unit cube in VTK's order.
constexpr std::array<std::array<int, 3>, 8> cube{
    {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}}};

// The six faces turned to be the bottom, each with the corners above it.
constexpr std::array<std::array<int, 8>, 6> turned{{{0, 1, 2, 3, 4, 5, 6, 7},
                                                    {4, 7, 6, 5, 0, 3, 2, 1},
                                                    {0, 4, 5, 1, 3, 7, 6, 2},
                                                    {3, 2, 6, 7, 0, 1, 5, 4},
                                                    {0, 3, 7, 4, 1, 2, 6, 5},
                                                    {1, 5, 6, 2, 0, 4, 7, 3}}};

Corners rotated(const Corners& corners, const std::array<int, 8>& face, std::size_t by) {
  Corners result{};
  for (std::size_t i = 0; i < 4; ++i) {
    result[i] = corners[static_cast<std::size_t>(face[(i + by) % 4])];
    result[i + 4] = corners[static_cast<std::size_t>(face[(i + by) % 4 + 4])];
  }
  return result;
}

// How well corners stand where those of the cube do; each axis in units of the cell's own extent.
double likeness(const Corners& corners, const MatrixD& points) {
  double sum = 0;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    double low = points(corners[0], axis), high = low, signed_sum = 0;
    for (std::size_t i = 0; i < 8; ++i) {
      const double x = points(corners[i], axis);
      low = std::min(low, x);
      high = std::max(high, x);
      signed_sum += cube[i][static_cast<std::size_t>(axis)] == 1 ? x : -x;
    }
    if (high > low) sum += signed_sum / (high - low);
  }
  return sum;
}

double signed_volume(const Corners& corners, const MatrixD& points) {
  std::array<field::Corner, 8> p;
  for (std::size_t i = 0; i < 8; ++i)
    p[i] = {points(corners[i], 0), points(corners[i], 1), points(corners[i], 2)};
  return field::hexahedron_volume(p);
}

}  // namespace

Corners corners_of(std::span<const std::int32_t> bottom, std::span<const std::int32_t> top) {
  check(bottom.size() == top.size() && (bottom.size() == 3 || bottom.size() == 4), "a cell's bottom");
  const auto last = bottom.size() - 1;
  return {bottom[0], bottom[1], bottom[2], bottom[last], top[0], top[1], top[2], top[last]};
}

Corners upright(const Corners& corners, const MatrixD& points) {
  if (std::set(corners.begin(), corners.end()).size() < 8) return corners;
  auto start = corners;
  if (signed_volume(corners, points) < 0)
    std::swap_ranges(start.begin(), start.begin() + 4, start.begin() + 4);
  auto best = start;
  for (const auto& face : turned) {
    for (std::size_t by = 0; by < 4; ++by) {
      const auto candidate = rotated(start, face, by);
      if (likeness(candidate, points) > likeness(best, points)) best = candidate;
    }
  }
  return best;
}

double volume_of(const Corners& corners, const MatrixD& points) {
  return std::abs(signed_volume(corners, points));
}

}  // namespace elrom::ingest
