#pragma once
// Scores of any bundles on any cases of a store: what accuracy reports and comparisons are made of.

#include <stop_token>

#include "elrom/base/log.hpp"
#include "elrom/report/accuracy.hpp"

namespace elrom::report {

struct EvaluateOptions {
  int n_threads = 1;
  bool figures = false;
};

/// @param study its bundles are scored, the first as the study's model, on its held-out cases; the mean of
/// its building cases is what errors are measured by
/// @throws InputError, Interrupted
[[nodiscard]] AccuracyReport evaluate_bundles(StudyFiles study, const EvaluateOptions& options, Log& log,
                                              const std::stop_token& stop);

}  // namespace elrom::report
