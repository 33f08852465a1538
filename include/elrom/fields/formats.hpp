#pragma once
// What a prediction can be written as. One table (formats.cpp) says everything that differs from format to
// format; command line, help, file endings and the Python package go by it.
//
// Thread rule: constants.

#include <span>
#include <string>
#include <string_view>

#include "elrom/fields/text_writer.hpp"

namespace elrom::fields {

enum class Format { hdf, csv, txt, ip, openfoam };

struct FormatInfo {
  Format format;
  const char* name;  ///< of --format, and the ending of the file; openfoam: a folder
  /// Adds a whole prediction to a text; nullptr: HDF5, written while it is
  /// computed (prediction_file.hpp), and openfoam, which lies on a mesh of its own.
  void (*write)(const model::PredictionFrame&, const Coordinates&, const model::Prediction&, std::string&);
  bool profiles;  ///< can hold plane averages
};

[[nodiscard]] std::span<const FormatInfo> formats();
[[nodiscard]] const FormatInfo& info_of(Format format);
/// @throws UsageError with the nearest name
[[nodiscard]] const FormatInfo& format_named(std::string_view name);

}  // namespace elrom::fields
