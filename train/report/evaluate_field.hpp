#pragma once
// One field of a report: every method on every scored case. Internal to evaluate*.cpp.

#include <algorithm>
#include <span>
#include <vector>

#include "elrom/field/snapshot_store.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/report/accuracy.hpp"

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

struct FieldTask {
  const field::SnapshotStore& store;
  const HeldOutCases& cases;
  const std::vector<BundleFile>& bundles;
  const field::FieldInfo& info;
  int n_threads;
};

/// @param figures where this field's drawings go (appended); nullptr: none
[[nodiscard]] FieldAccuracy evaluate_field(const FieldTask& task, Figures* figures);

/// Cuts and heights of the mesh; decides which methods' cuts are worth their size.
[[nodiscard]] Figures start_figures(const field::Mesh& mesh, const std::vector<BundleFile>& bundles,
                                    std::size_t n_fields, std::size_t n_cases);

}  // namespace elrom::report
