#pragma once
// Two bundles on the same cases, field by field: is B better than A, worse, or is no difference shown?
//
// Both predict the same cases, so that what counts is the ratio of their errors pooled over these; its
// interval comes from drawing the cases anew (accuracy.hpp, relative_gain), which keeps the two together.
// Cases that one of them was trained on are no test and are left out.
//
// Thread rule: compare() uses the threads it is given; the results are plain values.

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/report/accuracy.hpp"

namespace elrom::report {

struct CompareOptions {
  std::filesystem::path a, b;                  ///< bundles or studies
  std::vector<std::string> cases;              ///< names or patterns; empty: the held-out cases of A's study
  std::optional<std::filesystem::path> store;  ///< instead of the one of A's study
  int n_threads = 1;
  bool figures = false;
};

struct FieldComparison {
  std::string field;    ///< empty: the mean over fields
  double a = 0, b = 0;  ///< NRMSE
  Gain gain;            ///< of B over A: positive where B's error is smaller
};

struct Comparison {
  AccuracyReport report;       ///< methods: A, then B; fields that both have
  std::filesystem::path a, b;  ///< as they were named
  std::vector<FieldComparison> fields;
  FieldComparison mean;
  std::vector<std::string> left_out;  ///< cases that A or B was trained on
  std::vector<std::string> missing;   ///< fields of A that B lacks
  /// What decides the exit status: B's mean over fields is shown to be worse.
  [[nodiscard]] bool b_is_worse() const { return mean.gain.verdict() == Gain::Verdict::worse; }
};

/// @throws UsageError without a store or cases, and for a case by name that one of them was trained on;
/// InputError for bundles that cannot be compared, Interrupted
[[nodiscard]] Comparison compare(const CompareOptions& options, Log& log, const std::stop_token& stop = {});

/// "better", "worse", "no difference shown"
[[nodiscard]] std::string verdict_text(const Gain& gain);
/// Which is better, by how much, how sure that is, and in how many fields.
[[nodiscard]] std::string headline(const Comparison& comparison);
[[nodiscard]] std::string terminal_table(const Comparison& comparison);
/// Kind "elrom-comparison" of data/FORMATS.md.
[[nodiscard]] std::string to_json(const Comparison& comparison);
/// One file that opens offline. @param comparison with figures
[[nodiscard]] std::string html_page(const Comparison& comparison);

}  // namespace elrom::report
