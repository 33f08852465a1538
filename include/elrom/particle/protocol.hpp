#pragma once
// Which pairs are drawn for a set of collisions.
//
//   document  the source's: speeds and angles uniform (|V| in the range, phi in [0, 2 pi), theta in [0, pi]),
//             u = V sin(theta) cos(phi), v = V sin(theta) sin(phi), w = V cos(theta); both spheres aimed at
//             the origin so that they get there together. They touch on the line of their relative velocity:
//             every collision is central.
//   general   what a scene meets: directions uniform on the sphere, any impact point (uniform on the disc
//             across the relative velocity), sizes in a range, spins.
//
// Thread rule: pure functions. Pair i depends on the seed and on i alone.

#include <cstddef>
#include <cstdint>
#include <optional>

#include "elrom/base/enum_names.hpp"
#include "elrom/particle/pairs.hpp"

namespace elrom::particle {

enum class ProtocolKind { document, general };
inline constexpr base::EnumNames<ProtocolKind, 2> protocol_names{
    "protocol", {{ProtocolKind::document, "document"}, {ProtocolKind::general, "general"}}};

/// low to high; both the same: always that value
struct Range {
  double low = 0, high = 0;
  bool operator==(const Range&) const = default;
};

struct Protocol {
  ProtocolKind kind = ProtocolKind::general;
  Range speed{0, 20};                         ///< of each sphere, m/s
  Range diameter_1{315e-6, 315e-6};           ///< m, uniform
  Range diameter_2{315e-6, 315e-6};           ///< m, uniform
  double density_1 = 1000, density_2 = 1000;  ///< kg/m3
  /// Greatest surface speed r w of a sphere's spin, m/s; axes uniform on the sphere. 0: none. Document: none.
  double spin_speed = 0;
  /// The source's: spheres start this long before they would meet at the origin, s, wherever that is; slow
  /// pairs then overlap from the start. Missing: every pair starts as it touches. Document only.
  std::optional<double> approach_time;
  bool operator==(const Protocol&) const = default;

  /// @throws UsageError for what cannot be drawn: a range upside down, speeds that never meet ...
  void check() const;
};

/// Pairs first to first + count of the set with this seed. A pair that would never meet is drawn again.
[[nodiscard]] Pairs draw_pairs(const Protocol& protocol, std::uint64_t seed, std::size_t first,
                               std::size_t count);

}  // namespace elrom::particle
