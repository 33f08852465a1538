#pragma once
// What lowers the error: more cases, or averaging each of them for longer.
//
// More cases: a method of the study fitted anew on nested subsets of its training cases, always scored on the
// same held-out cases; and the source's comparison of v1 (a third of the cases) with v2 (all of them).
//
// Longer averaging: the noise of a time average falls as 1 / time. It cannot be taken out of the training
// cases, but more can be put in: the method is fitted to cases with added noise of the kind that repeated
// runs show, and its error drawn back to less noise than they have (simulation extrapolation, Cook and
// Stefanski 1994).
//
// Error: mean over fields of the pooled NRMSE, whose training mean is that of *all* training cases at every
// point, so that points differ by the model alone. Where every held-out case has repeated runs, errors stand
// beside it against the mean of its runs, the noise left in that mean taken off (signed_nrmse).

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/math/matrix.hpp"
#include "elrom/report/metrics.hpp"

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
  bool noise = true;  ///< also with noise added to the training cases; needs repeats of every held-out case
};

struct LearningPoint {
  std::size_t cases = 0;
  double error_mean = 0, error_std = 0;                        ///< over the draws
  std::map<std::string, double> field_error;                   ///< mean over the draws, by field
  double averaged_mean = undefined, averaged_std = undefined;  ///< against averaged truths; NaN: no repeats
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
  /// How many cases bring the error down to `error`; none for an error that the floor does not let be
  /// reached, and at_bound().
  [[nodiscard]] std::optional<double> cases_for(double error) const;
};
/// @param cases, errors the points, at least three of different size; fewer give a constant
[[nodiscard]] PowerLaw fit_power_law(const std::vector<double>& cases, const std::vector<double>& errors);

/// Error against the noise of the training cases. Of each field, against averaged truths:
/// NRMSE^2 = clean + noise * s, with s the variance of the noise (1: as the cases are; 1 / f: averaged f
/// times as long). A method that smooths more where there is more noise bends below that line, so less
/// noise is worth at least what it says.
struct AveragingCurve {
  struct Field {
    double clean = 0, noise = 0;
  };
  struct Level {
    double noise = 1;       ///< s
    double error_mean = 0;  ///< over fields and draws
  };
  std::map<std::string, Field> fields;  ///< empty: not known
  std::vector<Level> levels;            ///< as measured, by rising noise
  /// Mean error over the fields of cases averaged `factor` times as long, which may be infinite.
  [[nodiscard]] double at(double factor) const;
  /// The factor that brings the error down to `error`; none: no averaging does.
  [[nodiscard]] std::optional<double> factor_for(double error) const;
};
/// Least squares through the first level's shares. @param shares NRMSE^2 at each level, (n_fields, n_levels)
[[nodiscard]] AveragingCurve fit_averaging(const std::vector<std::string>& fields,
                                           const std::vector<double>& levels, const MatrixD& shares);

/// What one case costs, to say in hours what lowers the error. 0: not known.
struct CaseHours {
  std::string name = "CFD";
  double hours = 0;     ///< of one case
  double start_up = 0;  ///< of these, before averaging begins
};

struct LearningCurve {
  std::string study, method;
  std::vector<LearningPoint> points;  ///< by rising number of cases
  PowerLaw fit;
  /// Expected fall of the error, as a share, with 20 more cases; NaN for a fit at its bound
  double gain_next_20 = 0;
  bool small = false;     ///< a quick look: few sizes, one draw
  LearningPoint v1;       ///< a third of the cases
  LearningPoint v2;       ///< all of them
  PowerLaw averaged_fit;  ///< of averaged_mean
  AveragingCurve averaging;
  CaseHours price;
  [[nodiscard]] bool has_averaged_truth() const { return std::isfinite(v2.averaged_mean); }
};

/// One way to a wanted error against averaged truths, and the other.
struct Purchase {
  double error = 0;
  std::optional<double> cases;      ///< in all; none: not within `farthest` times those there are
  std::optional<double> averaging;  ///< times as long; none: not within `farthest`
  static constexpr double farthest = 10;
};
/// @param wanted errors; empty: 10, 20, 30 and 50 % below the error of all cases. None without averaged
/// truths.
[[nodiscard]] std::vector<Purchase> purchases(const LearningCurve& curve, std::vector<double> wanted = {});
/// Further hours of the solver, where its runs can go on from where they ended. NaN: not known.
[[nodiscard]] double hours_of_cases(const LearningCurve& curve, double cases);
[[nodiscard]] double hours_of_averaging(const LearningCurve& curve, double factor);

/// @throws InputError, UsageError, Interrupted
[[nodiscard]] LearningCurve learning_curve(const LearningCurveOptions& options, Log& log,
                                           const std::stop_token& stop = {});

/// Kind "elrom-learning-curve" of data/FORMATS.md.
[[nodiscard]] std::string to_json(const LearningCurve& curve);
[[nodiscard]] LearningCurve read_learning_curve(const std::filesystem::path& path);
[[nodiscard]] std::string terminal_table(const LearningCurve& curve);
/// What 20 more cases are expected to buy, or why these points do not tell: a sentence for terminal and page.
[[nodiscard]] std::string outlook(const LearningCurve& curve);
/// Both ways to lower errors beside each other; why they are not known, where there are no averaged truths.
[[nodiscard]] std::string purchase_table(const LearningCurve& curve, const std::vector<double>& wanted = {});
/// The source's table: error of v1 and v2 for each field.
[[nodiscard]] std::string v1_v2_table(const LearningCurve& curve);

}  // namespace elrom::report
