#pragma once
// Writing timing.json: seconds of each stage of the last run, and what was reused. Internal to the study.

#include <filesystem>

#include "elrom/io/stage_cache.hpp"
#include "elrom/study/timing.hpp"

namespace elrom::study {

/// Largest resident memory of this process so far [GiB].
[[nodiscard]] double peak_rss_gib();

/// Keeps, in "from_nothing", the seconds of the last run that reused nothing.
/// @param methods seconds that each method took when it was fitted, however long ago; NaN is left out
void write_timing(const std::filesystem::path& path,
                  const std::map<std::string, io::StageClock::Entry>& entries, double total_seconds,
                  int n_threads, const std::map<std::string, double>& methods = {});

}  // namespace elrom::study
