#pragma once
// The cases that a report judges on, and their truths: single runs, or the mean of all repeated runs.
// Internal to the report.

#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/report/study_files.hpp"

namespace elrom::report {

/// Rows of the store by what they are used for.
struct HeldOutCases {
  std::vector<std::size_t> building, scored;
  std::vector<std::vector<std::size_t>> repeats;  ///< runs of the same boundary conditions
  MatrixD inputs;                                 //!< of the scored cases, SI, (n_cases, n_inputs)

  /// Rows of all runs of a scored case, itself among them; empty: it has no repeated run.
  [[nodiscard]] std::span<const std::size_t> runs_of(std::size_t i_case) const {
    for (const auto& set : repeats)
      if (std::ranges::find(set, scored[i_case]) != set.end()) return set;
    return {};
  }
  [[nodiscard]] bool all_repeated() const {
    for (std::size_t i = 0; i < scored.size(); ++i)
      if (runs_of(i).empty()) return false;
    return true;
  }
};

inline std::span<const double> case_inputs(const HeldOutCases& cases, std::size_t i_case) {
  return {cases.inputs.row(static_cast<Eigen::Index>(i_case)).data(),
          static_cast<std::size_t>(cases.inputs.cols())};
}

/// The study's held-out cases, with repeated runs that came into the store since it was trained.
/// @throws UsageError when there is none, InputError
[[nodiscard]] HeldOutCases hold_out_cases(const field::SnapshotStore& store, const StudyFiles& study,
                                          Log& log);

/// Mean of all runs of each scored case, and the energy of the noise left in it.
struct AveragedTruth {
  MatrixF values;             //!< (n_cases, n_cells)
  std::vector<double> noise;  //!< (n_cases)
};
/// @param cases all_repeated()
[[nodiscard]] AveragedTruth averaged_truth(const field::SnapshotStore& store, const std::string& field,
                                           const HeldOutCases& cases);

}  // namespace elrom::report
