#pragma once
// Predictions as HDF5: our own group for scripts, and a /VTKHDF view of the same cells for ParaView 5.11 and
// later. Layout in data/FORMATS.md (kind "elrom-prediction").

#include <filesystem>

#include "prediction.hpp"

namespace elrom::predict {

/// Writes `path` (a temporary of the caller's). Thread rule: one thread at a time, as the HDF5 library wants
/// it.
void write_hdf(const Run& run, const Prediction& prediction, const std::filesystem::path& path);

}  // namespace elrom::predict
