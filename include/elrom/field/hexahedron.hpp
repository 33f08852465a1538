#pragma once
// Volume of a cell with eight corners in VTK's order.

#include <array>
#include <cstddef>

namespace elrom::field {

using Corner = std::array<double, 3>;  ///< [m]

/// [m3], positive where 0 1 2 3 turn to the left seen from the face 4 5 6 7. Signed sum over six tetrahedra
/// around the diagonal 0-6; exact for flat faces, also where corners coincide (wedge, pyramid, tetrahedron).
[[nodiscard]] double hexahedron_volume(const std::array<Corner, 8>& corners);

}  // namespace elrom::field
