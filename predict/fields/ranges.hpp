#pragma once
// "0:10,20,30:" and "x0:x1,y0:y1,z0:z1" as the command line writes them.

#include <array>
#include <cstdint>
#include <limits>
#include <string_view>
#include <vector>

namespace elrom::fields {

/// Planes, ascending, each once. "a:b" is a, ..., b - 1; a
/// missing side reaches to the end. Empty text: empty list.
/// @throws UsageError
[[nodiscard]] std::vector<std::int32_t> parse_planes(std::string_view text, std::size_t n_planes);

/// A box in space [m]; sides that were left out are infinite.
struct Box {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{-infinity, -infinity, -infinity};
  std::array<double, 3> high{infinity, infinity, infinity};
};
/// @throws UsageError
[[nodiscard]] Box parse_box(std::string_view text);

}  // namespace elrom::fields
