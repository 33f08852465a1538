#pragma once
// Predictions as HDF5: our own group for scripts, and a /VTKHDF view of the same cells for ParaView 5.11 and
// later. Layout in data/FORMATS.md (kind "elrom-prediction").

#include <filesystem>

#include "elrom/io/hdf5.hpp"
#include "prediction.hpp"

namespace elrom::fields {

/// A file in two steps, so that the first can run while the values are computed. Thread rule: one thread at a
/// time for all files, as the HDF5 library wants it.
class HdfWriter {
 public:
  /// Writes all of `path` (a temporary of the caller's) but values and physics. @throws SystemError
  HdfWriter(const Run& run, const field::CaseInputs& inputs, const model::Assessment& assessment,
            const std::filesystem::path& path);
  /// One field's values, before all are there. @throws SystemError
  void write_field(const Prediction& prediction, std::size_t i);
  /// The values of the other fields, the physics when asked for; closes the file. @throws SystemError
  void finish(const Prediction& prediction);

 private:
  const Run& run_;
  io::Hdf5File file_;
  std::vector<io::Hdf5Dataset> values_, half_width_;  ///< of each field
  std::vector<bool> written_;                         ///< of each field
};

/// Both steps.
void write_hdf(const Run& run, const Prediction& prediction, const std::filesystem::path& path);

}  // namespace elrom::fields
