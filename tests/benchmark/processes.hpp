#pragma once
// Whole processes timed from outside, and a neighbour that keeps a processor busy.

#include <sys/types.h>

#include <string>
#include <vector>

namespace elrom::benchmark {

struct Timings {
  double min_ms = 0, median_ms = 0;
  double peak_mib = 0;  ///< largest resident set of all runs
};

/// Runs `words` (program and arguments) once to warm up, if repeats > 1, then `repeats` times; output is
/// thrown away.
/// @throws Error when the program fails
[[nodiscard]] Timings time_process(const std::vector<std::string>& words, int repeats);

/// A process that computes without end while this object lives.
class BusyNeighbour {
 public:
  BusyNeighbour();
  ~BusyNeighbour();
  BusyNeighbour(const BusyNeighbour&) = delete;
  BusyNeighbour& operator=(const BusyNeighbour&) = delete;

 private:
  pid_t process_;
};

}  // namespace elrom::benchmark
