#pragma once
// One field of a report: every method on every scored case. Internal to evaluate*.cpp.

#include <algorithm>
#include <span>
#include <vector>

#include "elrom/field/snapshot_store.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/report/accuracy.hpp"
#include "held_out_cases.hpp"

namespace elrom::report {

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
