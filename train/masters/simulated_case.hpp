#pragma once
// A case that a simulation made, on its way from a store's reduced mesh to a file of fields, which others
// take it out of again (ingest::read_simulation).
//
// Thread rule: one thread at a time (HDF5).

#include <filesystem>
#include <string>

#include "elrom/field/snapshot_store.hpp"

namespace elrom::masters {

/// "el3d_0123456789ab": the same inputs simulated by the same model are the same case.
[[nodiscard]] std::string case_name(const std::string& model, const std::string& inputs_digest);

/// Writes the only case of a store as a file of kind elrom-prediction that names no bundle.
/// @param program what made it
void write_simulation(const field::SnapshotStore& store, const std::string& program,
                      const std::filesystem::path& file);

}  // namespace elrom::masters
