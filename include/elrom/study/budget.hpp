#pragma once
// A run within a given time: what it is spent on, most valuable first. A cost model says what fits: the
// kernel is fitted once to one field, on this machine and as busy as it is now, and everything else follows
// from that by counting fits. What has run then tells how far off that was, and what is left of the time
// goes to what fits now. What was left out is said, with what it would take.
//
// The choice is settings, which stand in resolved.toml as if they had been
// asked for, so that the same run can be repeated without a budget.

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/study/settings.hpp"

namespace elrom::study {

/// A way to spend time; a later one costs more and is expected to err less, or to be surer of its error.
struct BudgetLevel {
  std::string name;  ///< "kernel alone, 2 folds"
  Settings settings;
  double seconds = 0;  ///< wall, as the cost model expects it; 0: not known, or next to nothing
  std::string buys;    ///< over the level before
};

/// What the cost model knows of one study.
struct CostModel {
  double seconds_per_fit = 0;  ///< of the kernel on one field, one thread, wall
  std::size_t n_fields = 0;
  std::size_t n_cases = 0;  ///< that build
  int n_threads = 1;
  /// A run with networks at effort "quick", as a multiple of one without; of
  /// an earlier run of the study, else as on the shipped cases.
  double networks = 2;
  bool networks_had_no_part = false;  ///< in the study's present model, which tried them
};

/// Calibrates by one fit, and reads timing.json and the present model of the study where there are some.
[[nodiscard]] CostModel cost_model(const std::filesystem::path& folder, const Settings& settings, Log& log);

/// Cheapest first. Settings that bound a run already (no networks, fewer folds) are kept.
[[nodiscard]] std::vector<BudgetLevel> budget_levels(const Settings& settings, const CostModel& model);

/// What a run within a time came to.
struct BudgetRun {
  Settings settings;                ///< whose model stands
  std::optional<std::size_t> done;  ///< the dearest level that was finished; none: a simple peer stands in
  double pace = 1;                  ///< seconds that levels took, as a multiple of those expected
};

/// The level to run next: the dearest that fits into the time left, of those dearer than what is done;
/// networks only after a model that stands. Where none fits the next one, as long as it may: it is stopped
/// in time, and a later run goes on from there. With nothing done the dearest that is sure to fit, which
/// the first always is.
/// @param seconds left @param run done and pace so far
[[nodiscard]] std::optional<std::size_t> next_level(const std::vector<BudgetLevel>& levels, double seconds,
                                                    const BudgetRun& run);

/// What was not run, what it would take and what it may buy, a sentence each; never empty.
[[nodiscard]] std::vector<std::string> left_out(const std::vector<BudgetLevel>& levels, const BudgetRun& run);

/// Runs levels by `train`, each from where the last left the folder, as long as one fits. One that is not
/// done when the time is up is stopped; the one before it is then the result, or where there is none POD +
/// RBF, which takes seconds.
/// @param train one run with these settings, that ends with Interrupted when it is stopped
/// @throws Interrupted on `stop`; what `train` throws
[[nodiscard]] BudgetRun run_within(double seconds, const std::vector<BudgetLevel>& levels, Log& log,
                                   const std::stop_token& stop,
                                   const std::function<void(const Settings&, std::stop_token)>& train);

}  // namespace elrom::study
