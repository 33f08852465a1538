// Solids in the fields against the inventory of the boundary conditions, and the pressure they cause against
// their weight.

#include "physics_checks.hpp"

namespace elrom::ingest {
namespace {

// Solids that leave come back: the averages of the 64 shipped training cases hold 91 to 103 % of the
// inventory, on the CFD's mesh or on another. Twice as far off is wrong.
constexpr double least_held = 0.8, most_held = 1.25;

}  // namespace

std::vector<Reading> read_solids_inventory(const PhysicsView& view) {
  std::vector<Reading> readings;
  if (!view.audit) return readings;
  const auto& audit = *view.audit;
  // Without a description, the solids' density is a guess.
  if (view.one.furnace && audit.solids_kg && audit.inventory_kg) {
    readings.push_back({.check = "solids_inventory",
                        .quantity = "solid_volume_fraction",
                        .what = "solids in the fields over the inventory",
                        .value = *audit.solids_kg / *audit.inventory_kg,
                        .low = least_held,
                        .high = most_held,
                        .least_spread = 0.02});
  }
  if (audit.pressure_drop && audit.solids_weight) {
    readings.push_back({.check = "solids_inventory",
                        .quantity = "pressure",
                        .what = "pressure drop over the weight of the solids",
                        .value = *audit.pressure_drop / *audit.solids_weight,
                        .low = 0.03,
                        .high = 4,
                        .least_spread = 0.02});
  }
  return readings;
}

}  // namespace elrom::ingest
