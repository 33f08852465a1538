#pragma once
// Sends a hard data set through what ELROM does with data, and tells what became of it.

#include <filesystem>
#include <string>
#include <vector>

#include "hard_data.hpp"

namespace elrom::stability {

struct Outcome {
  std::string data, stage;  ///< "twelve_decades", "pod_gp"
  bool passed = false;      ///< finite numbers, or one of our errors
  std::string result;       ///< "finite", or the error's line, or what is wrong
};

/// Store written, opened and read back; checks; screening; every method fitted, bundled, and asked for
/// training cases, cases between them and cases far outside.
/// @param folder for files
[[nodiscard]] std::vector<Outcome> send_through(const HardData& data, const std::filesystem::path& folder);

/// Corners of the trained box (a sample): each input in its range, hardly ever a case. (n_corners, n_inputs)
[[nodiscard]] MatrixD box_corners(const MatrixD& inputs);

/// Inputs that nobody should ask for: all of them, or one alone, up to ten ranges beyond the trained box;
/// zeros; 1e6 times the largest; 1e300. (n_queries, n_inputs)
[[nodiscard]] MatrixD far_queries(const MatrixD& inputs);

}  // namespace elrom::stability
