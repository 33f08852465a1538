#pragma once
// Writing timing.json: seconds of each stage of the last run, and what was reused. Internal to the study.

#include <filesystem>

#include "elrom/base/stopwatch.hpp"
#include "elrom/io/stage_cache.hpp"
#include "elrom/study/timing.hpp"

namespace elrom::study {

/// Largest resident memory of this process so far [GiB].
[[nodiscard]] double peak_rss_gib();

/// Processor time of this process so far, all threads, [s].
[[nodiscard]] double processor_seconds();

/// Adds to a cost what passes until it is destroyed. Processor time is that of the whole process: one such
/// clock at a time.
class CostClock {
 public:
  explicit CostClock(MethodCost& cost);
  ~CostClock();
  CostClock(const CostClock&) = delete;
  CostClock& operator=(const CostClock&) = delete;

 private:
  MethodCost& cost_;
  base::Stopwatch watch_;
  double processor_;
};

/// What was fitted, however long ago, and what each part cost then.
struct FitCosts {
  std::map<std::string, double> methods;         ///< seconds of each bundle's method; NaN is left out
  std::map<std::string, double> processor;       ///< the same in processor seconds
  std::map<std::string, MethodCost> candidates;  ///< of the model: of each method that took part
};

/// Keeps, in "from_nothing", the seconds of the last run that reused nothing.
void write_timing(const std::filesystem::path& path,
                  const std::map<std::string, io::StageClock::Entry>& entries, double total_seconds,
                  int n_threads, const FitCosts& costs = {});

}  // namespace elrom::study
