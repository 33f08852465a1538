#pragma once
// Where the time of a run went, cold and warm told apart.

#include <filesystem>
#include <string>

namespace elrom::fields {

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
