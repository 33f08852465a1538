#pragma once
// Two colour maps of our own, even in perceived lightness: paths through the OKLab space (Ottosson 2020),
// where equal steps look equal. Sequential: dark blue over green to light yellow. Diverging: blue, white,
// red, equally dark at both ends.

#include <array>
#include <cstdint>
#include <string>

namespace elrom::report {

struct Rgb {
  std::uint8_t r = 0, g = 0, b = 0;
  bool operator==(const Rgb&) const = default;
};
using ColourMap = std::array<Rgb, 256>;

[[nodiscard]] ColourMap sequential_map();
[[nodiscard]] ColourMap diverging_map();
/// Perceived lightness of a colour, 0 black ... 1 white (L of OKLab).
[[nodiscard]] double lightness(Rgb colour);
/// 256 times "rrggbb", for the page's script.
[[nodiscard]] std::string to_hex(const ColourMap& map);

}  // namespace elrom::report
