#pragma once
// Accuracy of a study on the cases it never saw, beside every peer on the same cases.
//
// Held-out cases whose names begin with `rep` are repeated runs of the same boundary conditions: they give
// the noise of the truth and are not scored by themselves. Where every scored case has some, methods are also
// scored against the mean of all its runs, the noise left in that mean taken off
// (FieldAccuracy::averaged_nrmse); that is then the headline's measure. Statistics of the training set are
// those of all cases that are not held out.
//
// Thread rule: evaluate() uses the threads it is given; the results are plain values.

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/furnace.hpp"
#include "elrom/math/bootstrap.hpp"
#include "elrom/model/audit.hpp"
#include "elrom/model/guard.hpp"
#include "elrom/report/figures.hpp"
#include "elrom/report/metrics.hpp"
#include "elrom/report/study_files.hpp"

namespace elrom::report {

/// Levels at which promised and measured coverage are compared.
inline constexpr std::array<double, 4> coverage_levels{0.5, 0.8, 0.9, 0.95};

struct AccuracyOptions {
  std::filesystem::path study;
  std::optional<std::filesystem::path> store;  ///< instead of the study's
  std::vector<std::string> cases;  ///< to judge on, names or patterns; empty: those that the study held out
  std::vector<std::filesystem::path> against;  ///< further bundles or studies to show beside the peers
  int n_threads = 1;
  bool figures = false;  ///< slices, profiles and histograms too, for the page
};

/// A case that is scored.
struct ScoredCase {
  std::string name;
  double load = 0;  ///< NaN: not given
  model::Assessment validity;
  model::Audit truth_audit, prediction_audit;
};

struct WorstPlace {
  WorstCell cell;
  std::array<double, 3> position{};  ///< [m]
};

/// One method on one field.
struct MethodField {
  bool available = false;  ///< the bundle has this field
  std::string kind;        ///< what answers for the field: "kernel", "pod_gp", "networks" ...
  std::string detail;      ///< members and weights of a blend: "kernel 0.62, pod_gp 0.38"
  ErrorSums pooled;
  std::vector<ErrorSums> cases;     //!< (n_cases)
  std::vector<ErrorSums> averaged;  //!< against averaged truths, noise included, (n_cases); empty: none
  std::vector<WorstPlace> worst;    //!< (n_cases)
};

/// One band of a networks model.
struct SubmodelScore {
  std::string name;
  std::size_t n_cells = 0;
  ErrorSums sums;
};

/// What method `auto` went by: errors on training cases that a fit left out, fold by fold (NRMSE).
struct Choice {
  struct Candidate {
    std::string name;
    double nrmse = 0;    ///< NaN: it failed
    double weight = 0;   ///< in the model
    int left_after = 0;  ///< folds, as nothing could gain by it; 0: it was tried in all
  };
  std::vector<Candidate> candidates;  ///< empty: not known
  double nrmse = 0;                   ///< of what was chosen; NaN: not known
  double nrmse_by_band = 0;           ///< had each band of columns weights of its own; NaN: not known
  std::string scale;                  ///< that the field is learned over, as model::scale_of(); empty: none
};

struct FieldAccuracy {
  field::FieldInfo info;
  Choice choice;                         ///< of the study's model
  std::vector<MethodField> methods;      //!< in the order of AccuracyReport::methods
  std::vector<SubmodelScore> submodels;  //!< of the study's own networks, wherever they are; empty: none
  std::vector<double> noise;  ///< energy of the truth's noise in each scored case; empty: not known
  /// Its square root over the departure of the scored cases: the noise floor
  std::optional<double> noise_nrmse;
  /// Energy of the noise that is left in the mean of each case's n runs: that of one run, estimated from the
  /// same runs without bias, over n, (n_cases); empty: some case has no repeated run
  std::vector<double> averaged_noise;
  ErrorBudget budget;  ///< of the study's model
  //! Of the best fit with r modes of the training cases, (n_modes + 1)
  std::vector<double> compression_nrmse;
  std::vector<std::vector<double>> coverage;  //!< measured share, (levels, n_cases); empty: no promise made
  /// Against averaged truths with their noise taken off: r = (error - noise) / (departure - noise), its root
  /// with the sign of r. Negative where the estimate of the noise exceeds the error: taken for 0, it would
  /// promise a perfect model. NaN without averaged truths. @param cases to score together, also repeatedly
  [[nodiscard]] double averaged_nrmse(std::size_t method, std::span<const std::size_t> cases) const;
  [[nodiscard]] double noise_energy() const;  ///< of all scored cases together; 0 when not known
  [[nodiscard]] double nrmse(std::size_t method) const;
  /// With the noise of the truth taken off; NaN without repeated runs, and for an error below the noise.
  [[nodiscard]] double nrmse_without_noise(std::size_t method) const;
  /// The method's error is no larger than the noise that the repeated runs tell: nothing is left to take off.
  [[nodiscard]] bool below_noise(std::size_t method) const;
  /// Noise is known, and no method's error is below it: methods can be compared with the noise taken off.
  [[nodiscard]] bool above_noise() const;
};

/// How much smaller one method's error is than another's, and how sure that is.
struct Gain {
  double value = 0;                           ///< 1 - NRMSE / NRMSE of the other; NaN: not known
  std::optional<math::LikelyRange> interval;  ///< at gain_level, over the scored cases; none: too few cases
  enum class Verdict { better, worse, not_shown };
  [[nodiscard]] Verdict verdict() const;  ///< not shown: the interval holds 0, or there is none
};
/// Of all intervals of gains: two-sided, from math::bootstrap_interval with its draws and seed.
inline constexpr double gain_level = 0.9;

/// A method's mean error over the fields, and how far other cases of the kind would move it.
struct MeanError {
  double value = 0;                           ///< NaN: not known
  std::optional<math::LikelyRange> interval;  ///< at gain_level, over the scored cases; none: too few cases
};

/// Against what the errors of a comparison are taken.
enum class Truth { one_run, averaged };

struct MethodSummary {
  BundleFile file;
  std::string digest;
  std::vector<std::string> training_cases;
  /// Held-out cases that it was trained on, by name or by boundary conditions: no test of it
  std::vector<std::string> leaked_cases;
  bool other_cases = false;             ///< trained on other cases than the study's models
  double open_ms = 0, predict_ms = 0;   ///< all fields of one case, inside this process
  double mean_nrmse = 0;                ///< over the fields; NaN when one is missing
  double mean_nrmse_without_noise = 0;  ///< over the fields above the noise; NaN when there is none
};

struct AccuracyReport {
  StudyFiles study;
  std::string created;  ///< UTC
  std::size_t n_training = 0, n_planes = 0, n_columns = 0;
  std::vector<ScoredCase> cases;
  std::vector<MethodSummary> methods;  ///< the study's model first
  std::vector<FieldAccuracy> fields;
  std::vector<std::string> repeats;  ///< runs that gave the noise
  field::Words words;                ///< of the store's furnace description
  std::optional<Figures> figures;
  std::vector<std::size_t>
      runs;  ///< in each case's averaged truth, (n_cases); empty: some have no repeated run

  /// Every scored case's truth is known as the mean of several runs.
  [[nodiscard]] bool has_averaged_truth() const { return !runs.empty(); }
  /// Mean over the fields of FieldAccuracy::averaged_nrmse.
  [[nodiscard]] MeanError averaged_error(std::size_t method) const;
  /// The simple peer of the lowest averaged_error(), and the gain over it; none without averaged truths.
  [[nodiscard]] std::optional<std::size_t> best_averaged_peer() const;
  [[nodiscard]] Gain averaged_gain() const;
  /// Index of the simple peer with the lowest mean NRMSE; none without peers.
  [[nodiscard]] std::optional<std::size_t> best_peer() const;
  /// Index of the best simple peer in one field.
  [[nodiscard]] std::optional<std::size_t> best_peer(const FieldAccuracy& field) const;
  /// Over the best single peer, of the mean over fields; NaN without peers.
  [[nodiscard]] Gain gain() const;
  /// Of one field over its best single peer.
  [[nodiscard]] Gain gain(const FieldAccuracy& field) const;
  /// NaN also where the model or the best peer is below the noise in some field.
  [[nodiscard]] double gain_without_noise() const;
  /// Fields where the model's NRMSE is at or below that of every simple peer; of every other method shown.
  [[nodiscard]] std::size_t fields_won() const;
  [[nodiscard]] std::size_t fields_won_against_all() const;
  /// Indices of the fields where a method's NRMSE is below that of the study's model.
  [[nodiscard]] std::vector<std::size_t> fields_better(std::size_t method) const;
  /// Fields where the study's model is below the noise; where every method is above it.
  [[nodiscard]] std::size_t fields_below_noise() const;
  [[nodiscard]] std::size_t fields_above_noise() const;
  /// What sets a method apart from the others: "77 cases", "saw 5 held out"; empty: like for like.
  [[nodiscard]] std::vector<std::string> marks(std::size_t method) const;
  /// "ELROM (77 cases)"
  [[nodiscard]] std::string title(std::size_t method) const;
  /// Measured coverage over all fields and cases at a level's index; NaN when no field makes a promise.
  [[nodiscard]] double mean_coverage(std::size_t i_level) const;
};

/// @throws InputError, Interrupted
[[nodiscard]] AccuracyReport evaluate(const AccuracyOptions& options, Log& log,
                                      const std::stop_token& stop = {});

/// Of `fields` (their mean, where there are several) over the scored cases: `method` against `other`.
[[nodiscard]] Gain relative_gain(std::span<const FieldAccuracy> fields, std::size_t method, std::size_t other,
                                 Truth truth = Truth::one_run);
/// "9.9 % (90 % interval 4.1 to 14.2 %)" of the size of a gain; says so where no difference is shown.
[[nodiscard]] std::string in_words(const Gain& gain);

/// What was reached, against what how sure that is, where any other method shown is better, and what makes
/// methods unlike each other: the same sentences in terminal, JSON and page.
[[nodiscard]] std::string headline(const AccuracyReport& report);
/// Fields against methods for a terminal; `colour` uses ANSI sequences.
[[nodiscard]] std::string terminal_table(const AccuracyReport& report, bool colour);
/// Layouts in data/FORMATS.md (kind "elrom-accuracy").
[[nodiscard]] std::string to_json(const AccuracyReport& report);
[[nodiscard]] std::string to_csv(const AccuracyReport& report);

}  // namespace elrom::report
