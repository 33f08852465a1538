#pragma once
// Prediction files: one case as HDF5, our own group for scripts and a /VTKHDF view of the same cells for
// ParaView 5.11 and later. Layout in data/FORMATS.md (kind "elrom-prediction").
//
// Thread rule: one thread at a time for all files, as the HDF5 library wants it.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/io/hdf5.hpp"
#include "elrom/model/audit.hpp"
#include "elrom/model/extent.hpp"
#include "elrom/model/predictor.hpp"

namespace elrom::model {

/// What all predictions of a run share: by which model, of what.
struct PredictionFrame {
  std::vector<field::FieldInfo> fields;
  field::InputSchema schema;
  Extent extent;
  std::optional<double> level;  ///< set: half-widths are there
  std::string bundle_digest, mesh_digest, bundle_program, method;
  bool best_build_only = false;

  /// @param of an extent of the predictor's bundle, whose cells().planes() the predictor predicts
  PredictionFrame(const Predictor& predictor, Extent of);
  /// Without a bundle; the caller fills in the rest.
  explicit PredictionFrame(Extent of) : extent(std::move(of)) {}

  [[nodiscard]] std::size_t n_values() const { return extent.n_values(); }
};

/// One case. Thread rule: a plain view.
struct Prediction {
  const field::CaseInputs* inputs = nullptr;
  const Assessment* assessment = nullptr;
  std::span<const float> values;               //!< SI, (fields, n_values)
  std::span<const float> half_width;           //!< the same; empty without a level
  const Audit* audit = nullptr;                ///< of all cells as written; null: not asked for
  const ConservationChange* change = nullptr;  ///< what conserve() did; null: not asked for

  [[nodiscard]] std::span<const float> field(std::span<const float> all, const PredictionFrame& frame,
                                             std::size_t i) const {
    return all.subspan(i * frame.n_values(), frame.n_values());
  }
};

/// Writes the file of one case. It appears whole or not at all. @throws SystemError
void write_prediction(const PredictionFrame& frame, const Prediction& prediction,
                      const std::filesystem::path& path);

/// The same in two steps, so that the first can run while the values are computed.
class PredictionWriter {
 public:
  /// Writes all of `path` (a temporary of the caller's) but values and physics. @throws SystemError
  PredictionWriter(const PredictionFrame& frame, const field::CaseInputs& inputs,
                   const Assessment& assessment, const std::filesystem::path& path);
  /// One field's values, before all are there. @throws SystemError
  void write_field(const Prediction& prediction, std::size_t i);
  /// The values of the other fields, the physics when asked for; closes the file. @throws SystemError
  void finish(const Prediction& prediction);

 private:
  const PredictionFrame& frame_;
  io::Hdf5File file_;
  std::vector<io::Hdf5Dataset> values_, half_width_;  ///< of each field
  std::vector<bool> written_;                         ///< of each field
};

/// A prediction file, read whole.
struct StoredPrediction {
  struct Field {
    std::string name, unit;
    io::Shape shape;                ///< (planes, columns); of a region (cells); of profiles (planes)
    std::vector<float> values;      ///< SI
    std::vector<float> half_width;  ///< the same shape; empty: not asked for
  };
  std::string case_name, bundle_digest, mesh_digest, bundle_program, method, builds;
  std::string validity, validity_reason;   ///< "inside", "edge", "outside"
  std::vector<std::string> nearest_cases;  ///< nearest first
  std::optional<double> load;              ///< fraction of full load
  std::optional<double> interval_level;
  std::vector<std::string> input_names, input_units;  ///< SI
  std::vector<double> inputs;
  bool profiles = false;               ///< plane averages instead of cells
  std::vector<std::int32_t> planes;    ///< in the file, ascending
  std::vector<std::int32_t> cells;     ///< of a region: plane * n_columns + column; empty: whole planes
  std::vector<float> centre, heights;  ///< [m]: (cells, 3), or with profiles (planes); the other is empty
  std::vector<Field> fields;           ///< by name

  [[nodiscard]] const Field& field(const std::string& name) const;  ///< @throws UsageError, nearest name
};
/// @throws InputError for another kind of file, a newer major version, or one that is broken anywhere
[[nodiscard]] StoredPrediction read_prediction(const std::filesystem::path& path);

}  // namespace elrom::model
