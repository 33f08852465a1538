#pragma once
// Predictions as text: CSV, columns for SFW3D, Fluent interpolation
// file. Formats are described in data/FORMATS.md.

#include <map>
#include <string>
#include <vector>

#include "elrom/model/prediction_file.hpp"

namespace elrom::fields {

/// Where the values lie: x, y, z of cells, or z of planes.
struct Coordinates {
  std::vector<std::string> axes;
  std::vector<float> values;                      //!< [m], (n_values, axes.size())
  std::map<std::string, std::string> names = {};  ///< of fields, where a Fluent file is not to have the usual
};
[[nodiscard]] Coordinates coordinates_of(const model::PlaneAverage& average);
[[nodiscard]] Coordinates coordinates_of(const model::CellGeometry& geometry);
[[nodiscard]] Coordinates coordinates_of(const field::Mesh& mesh);  ///< all of its cells

/// Comma separated: plane, column, x, y, z, fields [, half-widths]; with profiles plane, z, fields.
void write_csv(const model::PredictionFrame& frame, const Coordinates& coordinates,
               const model::Prediction& prediction, std::string& text);
/// '#' header, then columns of fixed width: x y z and the fields; with profiles z and the fields.
void write_sfw3d(const model::PredictionFrame& frame, const Coordinates& coordinates,
                 const model::Prediction& prediction, std::string& text);
/// Names of the fields in a Fluent file: Fluent's own, but for those chosen. @throws UsageError where two are
/// alike
void expect_fluent_names_differ(const std::vector<field::FieldInfo>& fields,
                                const std::map<std::string, std::string>& chosen);
/// Fluent interpolation file, version 3, text. The places may be others than the frame's: the prediction has
/// a value of every field for each.
void write_fluent(const model::PredictionFrame& frame, const Coordinates& coordinates,
                  const model::Prediction& prediction, std::string& text);

}  // namespace elrom::fields
