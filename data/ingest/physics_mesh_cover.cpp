// Whether the CFD's mesh fills the reduced mesh, and no more: tells another furnace, another unit of length,
// a part of a mesh, an export with cells left out.

#include <algorithm>
#include <limits>

#include "physics_checks.hpp"

namespace elrom::ingest {
namespace {

Reading reading(const std::string& what, double value, double low, double high, double least_spread) {
  return {.check = "mesh_cover",
          .what = what,
          .value = value,
          .low = low,
          .high = high,
          .least_spread = least_spread};
}

}  // namespace

std::vector<Reading> read_mesh_cover(const PhysicsView& view) {
  std::vector<Reading> readings;
  if (const auto& coverage = view.one.coverage) {
    // Of one and the same furnace it is 0, however coarse or fine either mesh is.
    constexpr double most = 0.02, least_spread = 0.002;
    readings = {
        reading("share of reduced cells that the CFD's mesh does not reach", coverage->uncovered, 0, most,
                least_spread),
        reading("share of the CFD's cells beyond the reduced mesh", coverage->beyond, 0, most, least_spread),
        reading("volume of the CFD's cells over that of the reduced mesh", coverage->volume, 0.9, 1.1,
                physics_alone)};
  }
  // Near 0 where the meshes nest, whatever the fields; else what the reduced mesh cannot resolve.
  if (const auto& errors = view.one.resampling_error; !errors.empty()) {
    constexpr double nothing = 1e-5, least_spread = 0.3;
    readings.push_back(reading("error of resampling there and back, of the worst field,",
                               std::max(nothing, std::ranges::max(errors)), 0, physics_alone, least_spread));
    readings.back().logarithmic = true;
  }
  return readings;
}

}  // namespace elrom::ingest
