#pragma once
// How the position of a plane enters a network, beside the boundary conditions.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace elrom::model {

/// index: the plane's index alone, standardised over the planes (the source's input).
/// fourier: that, and sin(pi k t), cos(pi k t) for k = 1 ... n_frequencies with t = (plane + 1/2) / n_planes.
/// one_hot: one input a plane, 1 for its own plane and 0 for the others.
enum class PlaneEncodingKind { index, fourier, one_hot };
[[nodiscard]] std::string_view name_of(PlaneEncodingKind kind);
/// @throws InputError with the nearest name
[[nodiscard]] PlaneEncodingKind plane_encoding_of(std::string_view name);

struct PlaneEncoding {
  PlaneEncodingKind kind = PlaneEncodingKind::fourier;
  std::size_t n_planes = 0;
  std::size_t n_frequencies = 6;  ///< fourier only

  /// Number of inputs that a plane takes.
  [[nodiscard]] std::size_t size() const;
  /// @param out (size()) inputs of `plane`
  void encode(std::size_t plane, std::span<float> out) const;
  bool operator==(const PlaneEncoding&) const = default;
};

}  // namespace elrom::model
