#pragma once
// Predictions as text: CSV, columns for SFW3D, Fluent interpolation
// file. Formats are described in data/FORMATS.md.

#include <string>

#include "prediction.hpp"

namespace elrom::fields {

/// Comma separated: plane, column, x, y, z, fields [, half-widths]; with profiles plane, z, fields.
void write_csv(const Run& run, const Prediction& prediction, std::string& text);
/// '#' header, then columns of fixed width: x y z and the fields; with profiles z and the fields.
void write_sfw3d(const Run& run, const Prediction& prediction, std::string& text);
/// Fluent interpolation file, version 3, text.
void write_fluent(const Run& run, const Prediction& prediction, std::string& text);

}  // namespace elrom::fields
