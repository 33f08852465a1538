#include "elrom/field/hexahedron.hpp"

namespace elrom::field {
namespace {

double tetrahedron_volume(const Corner& o, const Corner& a, const Corner& b, const Corner& c) {
  const auto d = [&](const Corner& p, std::size_t i) { return p[i] - o[i]; };
  return (d(a, 0) * (d(b, 1) * d(c, 2) - d(b, 2) * d(c, 1)) +
          d(a, 1) * (d(b, 2) * d(c, 0) - d(b, 0) * d(c, 2)) +
          d(a, 2) * (d(b, 0) * d(c, 1) - d(b, 1) * d(c, 0))) /
         6;
}

}  // namespace

double hexahedron_volume(const std::array<Corner, 8>& corners) {
  static constexpr std::array<std::array<std::size_t, 2>, 6> edges{
      {{1, 2}, {2, 3}, {3, 7}, {7, 4}, {4, 5}, {5, 1}}};
  double volume = 0;
  for (const auto& [a, b] : edges)
    volume += tetrahedron_volume(corners[0], corners[a], corners[b], corners[6]);
  return volume;
}

}  // namespace elrom::field
