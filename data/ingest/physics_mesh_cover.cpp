// Whether the CFD's mesh fills the reduced mesh, and no more: tells another furnace, another unit of length,
// a part of a mesh.

#include "physics_checks.hpp"

namespace elrom::ingest {

std::vector<Reading> read_mesh_cover(const PhysicsView& view) {
  if (!view.one.coverage) return {};
  // Of one and the same furnace it is 0, however coarse or fine either mesh is.
  constexpr double most = 0.02, least_spread = 0.002;
  return {{.check = "mesh_cover",
           .what = "share of reduced cells that the CFD's mesh does not reach",
           .value = view.one.coverage->uncovered,
           .high = most,
           .least_spread = least_spread},
          {.check = "mesh_cover",
           .what = "share of the CFD's cells beyond the reduced mesh",
           .value = view.one.coverage->beyond,
           .high = most,
           .least_spread = least_spread}};
}

}  // namespace elrom::ingest
