#pragma once
// Momentum and kinetic energy of pairs, before a collision and after it.
//
// Thread rule: pure functions.

#include "elrom/particle/pairs.hpp"

namespace elrom::particle {

/// Of each vector.
[[nodiscard]] Scalars lengths(const Components& vectors);
/// Of translation and rotation, both spheres of each pair, J.
[[nodiscard]] Scalars kinetic_energy(const Pairs& pairs, const Motion& motion);
/// Linear momentum made or lost: |change| / (|p1| + |p2|) of each pair; 0 where both spheres rest before.
[[nodiscard]] Scalars momentum_errors(const Pairs& pairs, const Motion& after);
/// Energy made (lost: negative) as a share of what each pair had; 0 where both spheres rest before.
[[nodiscard]] Scalars energy_changes(const Pairs& pairs, const Motion& after);
/// Degrees; 0 where one of the two is none.
[[nodiscard]] Scalars angles_between(const Components& a, const Components& b);
/// Between relative velocity and normal, degrees: 0 head-on, 90 grazing.
[[nodiscard]] Scalars impact_angles(const Pairs& pairs);

}  // namespace elrom::particle
