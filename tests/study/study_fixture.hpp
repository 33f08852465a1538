#pragma once
// A small store of smooth cases.

#include <cmath>
#include <filesystem>
#include <string>

#include "elrom/base/random.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/field/snapshot_store.hpp"

namespace elrom::study {

inline field::Furnace small_furnace() {
  return {
      .name = "small",
      .solid_density = 2400,
      .packing_limit = 0.6,
      .held_out = {"load_*"},
      .openings = {{.inputs = "air", .low_m = 0, .high_m = 0}, {.inputs = "fuel", .low_m = 1, .high_m = 2}}};
}

/// Cases with loads from 0.4 to 1.0; field values are smooth functions of load, a second input, height and
/// column. Every fifth case is named "load_*", as held-out cases are.
inline void write_small_store(const std::filesystem::path& path, std::size_t n_cases, std::size_t first = 0,
                              const std::optional<field::Furnace>& furnace = small_furnace(),
                              const field::Mesh& mesh = field::make_furnace_mesh({}, 2, 3, 4)) {
  const field::InputSchema schema(
      {{"air", "kg/s", "kg/s"}, {"fuel", "kg/s", "kg/s"}, {"constant", "1", "1"}});
  const std::vector<field::FieldInfo> fields{field::field_info("pressure", "Pa"),
                                             field::field_info("gas_velocity_z", "m/s")};
  field::SnapshotWriter writer(path, mesh, schema, fields, furnace);
  for (std::size_t i = first; i < first + n_cases; ++i) {
    base::Random random(base::Seed(11).derive(i));
    const double load = random.uniform(0.4, 1.0), fuel = random.uniform(1, 2);
    field::Snapshot snapshot;
    snapshot.record.inputs = {
        (i % 5 == 4 ? "load_" : "train_") + std::to_string(i), load, {100 * load, fuel, 3.0}};
    snapshot.record.source = "generated";
    snapshot.fields.resize(2, static_cast<Eigen::Index>(mesh.n_cells()));
    for (Eigen::Index c = 0; c < snapshot.fields.cols(); ++c) {
      const double z = mesh.centre(c, 2) / 47, y = mesh.centre(c, 1) / 27;
      snapshot.fields(0, c) = static_cast<float>(1000 * load * (1 - z) + 50 * fuel * y + 3 * random.normal());
      snapshot.fields(1, c) =
          static_cast<float>(4 * load * std::sin(3 * z) + fuel * y * y + 0.3 * random.normal());
    }
    writer.add(snapshot);
  }
  writer.commit();
}

}  // namespace elrom::study
