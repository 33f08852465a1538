#pragma once
// The report as one HTML file that opens offline: styles,
// script, drawings and data are inside; nothing is fetched.

#include <optional>
#include <string>
#include <vector>

#include "elrom/networks/trial_store.hpp"
#include "elrom/report/accuracy.hpp"
#include "elrom/report/cost.hpp"
#include "elrom/report/learning_curve.hpp"

namespace elrom::report {

/// Parts of the page that come from other commands, where they have been run.
struct PageExtras {
  std::optional<LearningCurve> learning_curve;
  std::optional<CostReport> cost;
  std::vector<networks::TrialStore::Search> searches;
};

/// What lies in the study's directory: learning-curve.json, else learning-curve-small.json, which says that
/// it is a quick look; cost.json, search.sqlite. Missing parts stay empty.
[[nodiscard]] PageExtras find_extras(const StudyFiles& study);

/// @param report with figures
[[nodiscard]] std::string html_page(const AccuracyReport& report, const PageExtras& extras = {});

}  // namespace elrom::report
