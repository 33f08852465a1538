#pragma once
// Several numbers side by side in the lanes of the processor, and vectors of them.

#include <algorithm>
#include <cstddef>
#include <experimental/simd>

namespace elrom::particle {

using Lane = std::experimental::native_simd<double>;
using Mask = Lane::mask_type;
inline constexpr std::size_t lane_width = Lane::size();

using std::experimental::all_of;
using std::experimental::any_of;
using std::experimental::max;
using std::experimental::min;
using std::experimental::none_of;
using std::experimental::reduce;
using std::experimental::sqrt;

inline Lane select(const Mask& mask, Lane yes, const Lane& no) {
  std::experimental::where(!mask, yes) = no;
  return yes;
}

struct LaneVector {
  Lane x, y, z;

  LaneVector& operator+=(const LaneVector& other) { return x += other.x, y += other.y, z += other.z, *this; }
  LaneVector& operator-=(const LaneVector& other) { return x -= other.x, y -= other.y, z -= other.z, *this; }
  LaneVector& operator*=(const Lane& factor) { return x *= factor, y *= factor, z *= factor, *this; }
  friend LaneVector operator+(LaneVector a, const LaneVector& b) { return a += b; }
  friend LaneVector operator-(LaneVector a, const LaneVector& b) { return a -= b; }
  friend LaneVector operator*(const Lane& factor, LaneVector a) { return a *= factor; }
};

inline Lane dot(const LaneVector& a, const LaneVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

inline LaneVector cross(const LaneVector& a, const LaneVector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

inline LaneVector select(const Mask& mask, const LaneVector& yes, const LaneVector& no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}

/// Lanes from `first` on; those past the end repeat the last one.
template <class Array>
Lane load(const Array& values, std::size_t first, std::size_t column = 0) {
  const auto n = static_cast<std::size_t>(values.rows());
  const double* data = values.data() + column * n;
  if (first + lane_width <= n) return Lane(data + first, std::experimental::element_aligned);
  return Lane([&](auto i) { return data[std::min(first + i, n - 1)]; });
}

template <class Array>
LaneVector load_vector(const Array& values, std::size_t first) {
  return {load(values, first, 0), load(values, first, 1), load(values, first, 2)};
}

template <class Array>
void store(const Lane& lane, Array& values, std::size_t first, std::size_t column = 0) {
  const auto n = static_cast<std::size_t>(values.rows());
  double* data = values.data() + column * n;
  if (first + lane_width <= n) return lane.copy_to(data + first, std::experimental::element_aligned);
  for (std::size_t i = 0; first + i < n; ++i) data[first + i] = lane[i];
}

template <class Array>
void store(const LaneVector& lanes, Array& values, std::size_t first) {
  store(lanes.x, values, first, 0);
  store(lanes.y, values, first, 1);
  store(lanes.z, values, first, 2);
}

}  // namespace elrom::particle
