#pragma once
// What accuracy costs in time: error, training time and prediction time of every bundle of some studies, and
// which of them no other beats in all three. With the studies of an ablation it is the ablation table:
// changes are against the first.

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"

namespace elrom::report {

struct CostPoint {
  std::string name;                     ///< "study" or "study: peer"
  double error = 0;                     ///< mean NRMSE over fields on the held-out cases
  std::optional<double> train_seconds;  ///< as the study measured it; none: not kept
  double predict_ms = 0;                ///< all fields of one case, opening included
  bool front = false;                   ///< no other point is at least as good in all and better in one
};

struct CostOptions {
  std::vector<std::filesystem::path> studies;
  std::optional<std::filesystem::path> store;
  bool peers = true;  ///< the studies' peers too
  int n_threads = 1;
};

struct CostReport {
  std::vector<CostPoint> points;
};

/// Marks the front. A missing training time counts as the longest.
void mark_front(std::vector<CostPoint>& points);

/// @throws InputError, Interrupted
[[nodiscard]] CostReport cost_report(const CostOptions& options, Log& log, const std::stop_token& stop = {});

/// Kind "elrom-cost" of data/FORMATS.md.
[[nodiscard]] std::string to_json(const CostReport& report);
[[nodiscard]] CostReport read_cost_report(const std::filesystem::path& path);
[[nodiscard]] std::string terminal_table(const CostReport& report);

}  // namespace elrom::report
