#pragma once
// What a study's timing.json tells (data/FORMATS.md, kind "elrom-timing"). Seconds throughout.

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace elrom::study {

struct StudyTiming {
  double total_seconds = 0;
  double peak_rss_gib = 0;
  std::map<std::string, double> stages;   ///< summed over results that may have run side by side
  std::map<std::string, double> methods;  ///< that each method took when it was fitted
  std::optional<double> full_seconds;     ///< total of the last run that reused no model; nothing: none yet
  std::map<std::string, double> full_stages;
};

/// @return nothing where there is no such file
/// @throws InputError for another kind or version of file, or a damaged one
[[nodiscard]] std::optional<StudyTiming> read_timing(const std::filesystem::path& path);

}  // namespace elrom::study
