#pragma once
// Where the time of a run went, cold and warm told apart.

#include <chrono>
#include <filesystem>
#include <string>

namespace elrom::fields {

class Stopwatch {
 public:
  /// Seconds since the last call, or since the beginning.
  double lap() {
    const auto now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

struct Timing {
  double open = 0;     ///< header of the bundle, cases, mesh
  double read = 0;     ///< models: their tensors read, compared with their digests, made ready
  double prepare = 0;  ///< what all output files share
  double compute = 0;  ///< guard and models, summed over cases and threads
  double write = 0;    ///< files, summed over cases and threads
  double wall = 0;     ///< from the beginning of main

  [[nodiscard]] std::string text(std::size_t n_cases) const;
};

/// Share of a file that lies in the page cache, 0 to 1; asked before the file is touched.
[[nodiscard]] double cached_share(const std::filesystem::path& path);
/// "12 pages read from disk, 3400 mapped"
[[nodiscard]] std::string page_faults();

}  // namespace elrom::fields
