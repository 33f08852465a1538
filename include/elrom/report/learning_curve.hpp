#pragma once
// What more cases buy: a method of the study fitted anew on nested subsets of
// its training cases, always scored on the same held-out cases; and the
// source's comparison of v1 (a third of the cases) with v2 (all of them).
//
// Error: mean over fields of the pooled NRMSE, whose training mean is that of *all* training cases at every
// point, so that points differ by the model alone.

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"

namespace elrom::report {

struct LearningCurveOptions {
  std::filesystem::path study;
  std::optional<std::filesystem::path> store;
  std::vector<std::string> cases;  ///< to judge on, names or patterns; empty: those that the study held out
  /// A peer's name; empty: the one that answers for most fields of the study, or the best peer
  std::string method;
  std::vector<std::string> fields;  ///< empty: all of the study
  int n_points = 5;   ///< subset sizes, evenly spaced in the logarithm, from an eighth of the cases to all
  int n_repeats = 3;  ///< nested draws
  std::uint64_t seed = 1;
  int n_threads = 1;
};

struct LearningPoint {
  std::size_t cases = 0;
  double error_mean = 0, error_std = 0;       ///< over the draws
  std::map<std::string, double> field_error;  ///< mean over the draws, by field
  /// Of the fits of all fields, all threads: mean and standard deviation over the draws; not in files.
  double processor_seconds = 0, processor_spread = 0;
};

/// error(n) = floor + scale * n^-rate, by least squares; the rate within its range, floor and scale are >= 0.
struct PowerLaw {
  static constexpr double least_rate = 0.05, most_rate = 2.0;
  double floor = 0, scale = 0, rate = 0;
  [[nodiscard]] double at(double n_cases) const;
  /// The points asked for more than the law can give: a rate beyond its range, an error that rises, or one
  /// that would fall below nothing. It then draws a line through them, but says nothing of more cases.
  [[nodiscard]] bool at_bound() const;
};
/// @param cases, errors the points, at least three of different size; fewer give a constant
[[nodiscard]] PowerLaw fit_power_law(const std::vector<double>& cases, const std::vector<double>& errors);

struct LearningCurve {
  std::string study, method;
  std::vector<LearningPoint> points;  ///< by rising number of cases
  PowerLaw fit;
  /// Expected fall of the error, as a share, with 20 more cases; NaN for a fit at its bound
  double gain_next_20 = 0;
  bool small = false;  ///< a quick look: few sizes, one draw
  LearningPoint v1;    ///< a third of the cases
  LearningPoint v2;    ///< all of them
};

/// @throws InputError, UsageError, Interrupted
[[nodiscard]] LearningCurve learning_curve(const LearningCurveOptions& options, Log& log,
                                           const std::stop_token& stop = {});

/// Kind "elrom-learning-curve" of data/FORMATS.md.
[[nodiscard]] std::string to_json(const LearningCurve& curve);
[[nodiscard]] LearningCurve read_learning_curve(const std::filesystem::path& path);
[[nodiscard]] std::string terminal_table(const LearningCurve& curve);
/// What 20 more cases are expected to buy, or why these points do not tell: a sentence for terminal and page.
[[nodiscard]] std::string outlook(const LearningCurve& curve);
/// The source's table: error of v1 and v2 for each field.
[[nodiscard]] std::string v1_v2_table(const LearningCurve& curve);

}  // namespace elrom::report
