#pragma once
// What accuracy costs in time: error, training time and prediction time of every bundle of some studies, what
// each method that took part in a model cost, and which of them no other beats in all three. With the studies
// of an ablation it is the ablation table: changes are against the first.
//
// Times are processor seconds where a study kept them (all threads of the process), so that a busy machine
// does not change them; wall seconds else. Thread rule: pure functions.

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
  double predict_ms = 0;       ///< all fields of one case, opening included; median of the repeats; NaN: no
  bool front = false;          ///< no other point is at least as good in all and better in one
  double error_deviation = 0;  ///< standard error over the held-out cases (jackknife); 0: not known
  std::optional<double> train_processor_seconds;  ///< none: not kept
  double predict_spread_ms = 0;                   ///< robust standard deviation of the repeats
  std::size_t cases = 0;                          ///< a method's fit alone to so many cases; 0: a bundle
  double train_spread_seconds = 0;  ///< of the repeats, as many draws of the cases; 0: not known
};

/// What computes the cases, for the same axes.
struct Reference {
  std::string name = "CFD";
  double hours = 0;    ///< wall, one case; 0: not known
  double cores = 1;    ///< at work all the time
  double error = 0;    ///< scatter of one run about its own mean, as NRMSE; 0: not known
  double n_cases = 0;  ///< that the first study was trained on
};

/// A method that took part in a study's model.
struct PartCost {
  std::string study, method;
  double processor_seconds = 0;
  int fields = 0, fields_used = 0;  ///< it was tried for, and has a weight in
  double error = 0;                 ///< of its own bundle on the held-out cases; NaN: there is none
};

struct CostOptions {
  std::vector<std::filesystem::path> studies;
  std::optional<std::filesystem::path> store;
  std::vector<std::string> cases;  ///< to judge on, names or patterns; empty: those that the study held out
  bool peers = true;               ///< the studies' peers too
  bool sizes =
      false;  ///< and what fits without networks to fewer of the first study's cases cost: add_sizes()
  int n_threads = 1;
  Reference reference;  ///< error and n_cases are filled in
};

struct CostReport {
  std::vector<CostPoint> points;
  Reference reference;
  std::vector<PartCost> parts;
};

struct AccuracyReport;

/// Adds what one evaluated study tells. Opens and predicts each bundle a few times: some seconds.
void add_points(CostReport& report, const AccuracyReport& accuracy, bool peers);

/// Every method that needs no search, fitted to a few sizes of a study's cases, three draws each. Half a
/// minute.
void add_sizes(CostReport& report, const CostOptions& options, Log& log, const std::stop_token& stop = {});

/// What follows from the points, a sentence each: the front, what each costly method buys, and the reference.
[[nodiscard]] std::vector<std::string> in_words(const CostReport& report);

/// Marks the front. A missing training time counts as the longest.
void mark_front(std::vector<CostPoint>& points);

/// @throws InputError, Interrupted
[[nodiscard]] CostReport cost_report(const CostOptions& options, Log& log, const std::stop_token& stop = {});

/// Kind "elrom-cost" of data/FORMATS.md.
[[nodiscard]] std::string to_json(const CostReport& report);
[[nodiscard]] CostReport read_cost_report(const std::filesystem::path& path);
[[nodiscard]] std::string terminal_table(const CostReport& report);
/// "1 min 38 s", "2.1 s +- 0.2 s", "12 s (wall)", "not kept"; "17.9 +- 0.1 ms", "not timed".
[[nodiscard]] std::string training_text(const CostPoint& point);
[[nodiscard]] std::string prediction_text(const CostPoint& point);

}  // namespace elrom::report
