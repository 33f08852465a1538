#pragma once
// A prediction as a caller wants it: numbers in JSON, float32 behind a JSON header, or the HDF5 file of
// elrom-predict.
//
// Thread rule: any thread.

#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cuts.hpp"
#include "elrom/model/prediction_file.hpp"
#include "elrom/serve/resident_model.hpp"
#include "json_body.hpp"

namespace elrom::serve {

struct Predicted {
  const OpenModel& model;
  const field::CaseInputs& inputs;
  const model::Assessment& assessment;
  const std::vector<std::size_t>& i_fields;
  const OpenModel::Values& values;  ///< of all cells, or of the parts
  Excerpt excerpt = {};
  const ExcerptParts* parts = nullptr;  ///< nullptr: all cells

  [[nodiscard]] std::size_t n_values() const { return parts ? parts->n_values() : model.n_cells(); }
};

/// {"case", "model", "verdict", "reason", "out_of_range", "unusual", "distance", "nearest", "planes",
/// "columns", "level", "fields": {name: {"unit", "values": [...], "half_width": [...]}}}; of an excerpt also
/// "parts": [{"axis": "x", "at": 5.3, "places": [begin, end)}, {"profile": true, "places": ...}] in each
/// field's values.
[[nodiscard]] std::string json_answer(const Predicted& predicted);
/// u64 length of the header, little-endian; the header, which is the JSON above but with "values" and
/// "half_width" the places [begin, end) of float32 in what follows; blanks up to a multiple of 8; the
/// float32, little-endian.
[[nodiscard]] std::string binary_answer(const Predicted& predicted);
/// @param predicted all cells @param hdf5 held while the library works @param folder for the file on its way
[[nodiscard]] std::string hdf_answer(const Predicted& predicted, std::mutex& hdf5,
                                     const std::filesystem::path& folder);
/// As binary_answer(), with "cells" (int32: numbers in the mesh), "offsets" (int32: of each cell's points,
/// and the end) and "points" (float32: x, y, z [m]) as places of four bytes.
[[nodiscard]] std::string polygons_answer(const Cut& cut, const CutPolygons& polygons);
/// Kept fields where a cut meets the cells, in the order of its polygons: "axis", "at" and
/// "fields": {name: {"unit", "values": places of float32}}.
/// @param cells of the cut, where the file has values of all of them; nothing: "fields" is null
[[nodiscard]] std::string cut_answer(const Cut& cut, const model::StoredPrediction& stored,
                                     const std::optional<std::vector<std::int32_t>>& cells);

}  // namespace elrom::serve
