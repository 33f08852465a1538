#pragma once
// What a study's timing.json tells (data/FORMATS.md, kind "elrom-timing"). Seconds throughout.

#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace elrom::study {

/// Fit, cross-validation and intervals of one method, summed over fields.
struct MethodCost {
  double seconds = 0;            ///< wall
  double processor_seconds = 0;  ///< of all threads of this process, not of others that trained for it
};

struct StudyTiming {
  double total_seconds = 0;
  int threads = 1;
  double processor_seconds = 0;  ///< 0: not kept
  double peak_rss_gib = 0;
  std::map<std::string, double> stages;   ///< summed over results that may have run side by side
  std::map<std::string, double> methods;  ///< that each method took when it was fitted
  std::map<std::string, double> method_processor_seconds;
  std::map<std::string, MethodCost> candidates;  ///< of each method that took part in the model
  std::optional<double> full_seconds;  ///< total of the last run that reused no model; nothing: none yet
  std::map<std::string, double> full_stages;
};

/// @return nothing where there is no such file
/// @throws InputError for another kind or version of file, or a damaged one
[[nodiscard]] std::optional<StudyTiming> read_timing(const std::filesystem::path& path);

}  // namespace elrom::study
