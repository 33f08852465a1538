#include "colour_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace elrom::report {
namespace {

struct Lab {
  double l, a, b;
};

// OKLab to linear sRGB and back: matrices of Ottosson (2020),
// "A perceptual color space for image processing".
std::array<double, 3> linear_rgb(const Lab& c) {
  const double l = std::pow(c.l + 0.3963377774 * c.a + 0.2158037573 * c.b, 3);
  const double m = std::pow(c.l - 0.1055613458 * c.a - 0.0638541728 * c.b, 3);
  const double s = std::pow(c.l - 0.0894841775 * c.a - 1.2914855480 * c.b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool displayable(const Lab& c) {
  const auto rgb = linear_rgb(c);
  return std::all_of(rgb.begin(), rgb.end(), [](double v) { return v >= -1e-6 && v <= 1 + 1e-6; });
}

std::uint8_t encode(double linear) {
  const double v = std::clamp(linear, 0.0, 1.0);
  const double gamma = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * gamma));
}

double decode(std::uint8_t value) {
  const double v = value / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

// The most colourful displayable colour of a lightness and hue,
// up to `chroma`: lightness is never traded for colour.
Rgb colour(double l, double chroma, double hue_degrees) {
  const double hue = hue_degrees * std::numbers::pi / 180;
  const auto lab = [&](double c) { return Lab{l, c * std::cos(hue), c * std::sin(hue)}; };
  double low = 0, high = chroma;
  if (displayable(lab(high))) low = high;
  for (int i = 0; i < 30 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (displayable(lab(middle)) ? low : high) = middle;
  }
  const auto rgb = linear_rgb(lab(low));
  return {encode(rgb[0]), encode(rgb[1]), encode(rgb[2])};
}

}  // namespace

ColourMap sequential_map() {
  ColourMap map;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double t = static_cast<double>(i) / 255;
    map[i] = colour(0.20 + 0.74 * t, 0.10 + 0.06 * t, 290 - 185 * std::pow(t, 1.1));
  }
  return map;
}

ColourMap diverging_map() {
  ColourMap map;
  for (std::size_t i = 0; i < map.size(); ++i) {
    const double t = static_cast<double>(i) / 127.5 - 1;  // -1 ... 1
    const double distance = std::abs(t);
    map[i] = colour(0.97 - 0.55 * distance, 0.19 * std::pow(distance, 0.8), t < 0 ? 255 : 30);
  }
  return map;
}

double lightness(Rgb c) {
  const double r = decode(c.r), g = decode(c.g), b = decode(c.b);
  const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
  const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
  const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
  return 0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s;
}

std::string to_hex(const ColourMap& map) {
  std::string text;
  for (const auto& c : map) text += fmt::format("{:02x}{:02x}{:02x}", c.r, c.g, c.b);
  return text;
}

}  // namespace elrom::report
