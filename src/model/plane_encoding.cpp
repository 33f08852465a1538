#include "elrom/model/plane_encoding.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "elrom/base/enum_names.hpp"

namespace elrom::model {
namespace {

constexpr base::EnumNames<PlaneEncodingKind, 3> encodings{"plane encoding",
                                                          {{PlaneEncodingKind::index, "index"},
                                                           {PlaneEncodingKind::fourier, "fourier"},
                                                           {PlaneEncodingKind::one_hot, "one_hot"}}};

/// (plane - mean) / standard deviation over 0 ... n_planes - 1; 0 for a single plane.
double standardised_index(std::size_t plane, std::size_t n_planes) {
  const auto n = static_cast<double>(n_planes);
  const double deviation = std::sqrt((n * n - 1) / 12);
  return deviation > 0 ? (static_cast<double>(plane) - (n - 1) / 2) / deviation : 0;
}

}  // namespace

std::string_view name_of(PlaneEncodingKind kind) { return encodings.name(kind); }
PlaneEncodingKind plane_encoding_of(std::string_view name) { return encodings.value(name); }

std::size_t PlaneEncoding::size() const {
  switch (kind) {
    case PlaneEncodingKind::index:
      return 1;
    case PlaneEncodingKind::fourier:
      return 1 + 2 * n_frequencies;
    case PlaneEncodingKind::one_hot:
      return n_planes;
  }
  return 0;
}

void PlaneEncoding::encode(std::size_t plane, std::span<float> out) const {
  check(plane < n_planes && out.size() == size(), "a plane of the mesh and room for its inputs");
  if (kind == PlaneEncodingKind::one_hot) {
    std::fill(out.begin(), out.end(), 0.0F);
    out[plane] = 1;
    return;
  }
  out[0] = static_cast<float>(standardised_index(plane, n_planes));
  if (kind == PlaneEncodingKind::index) return;
  const double t = (static_cast<double>(plane) + 0.5) / static_cast<double>(n_planes);
  for (std::size_t k = 1; k <= n_frequencies; ++k) {
    const double angle = std::numbers::pi * static_cast<double>(k) * t;
    out[2 * k - 1] = static_cast<float>(std::sin(angle));
    out[2 * k] = static_cast<float>(std::cos(angle));
  }
}

}  // namespace elrom::model
