#pragma once
// The gate: may a new model take the place of the present one? Field by field, on cases that neither has
// seen, with the report's own NRMSE (scores.hpp).
//
// Both models predict the same cases, so what counts is the difference of their squared errors, case by
// case. With truth y = m + e (m its mean, e the scatter of one run), predictions p (present) and q (new),
// d = q - p:
//   |q - y|^2 - |p - y|^2 = |q - m|^2 - |p - m|^2 - 2 d . e
// so that the scatter of one run gives this difference the variance 4 E (d . e)^2. It is estimated by
// putting samples of e in: deviations of repeated runs from their mean (over n - 1, scaled to the case's
// load as reports do); where no case was repeated, the errors of the better model on the other cases,
// which hold its own error too and so make the gate doubt more. The cases add up, and the root over the
// departure of the truth from the training mean and the sum of the two NRMSE is the scatter of their
// difference, since b^2 - a^2 = (b - a)(b + a).
//
// Without held-out cases, the squared errors that each bundle keeps of its own cross-validation are
// compared on the cases that both were trained on; the scatter is that of the sum of paired differences,
// sqrt(n) times their standard deviation across cases (paired t test). Bundles before 1.2 keep no such
// errors: then only their mean cross-validated NRMSE is compared, without a scatter.
//
// A field is worse when its NRMSE grew by more than the tolerance and by more than so many standard
// deviations of scatter; better, when it fell by so many; else the same. A growth of ten tolerances is
// worse whatever the scatter: one wild case among few makes a scatter that excuses itself. The mean over
// fields is judged alike, with the mean of the scatters (errors of fields go together). A model passes
// when no field and not the mean are worse, and no field is lost.
//
// The defaults: on the shipped cases (64 in batches of 8 from 24, kernel smoother, five held-out loads) no
// field lost more than 0.005 but pressure once, 0.035 at a scatter of 0.020; all five batches pass.
//
// Thread rule: pure functions of files.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/field/snapshot_store.hpp"
#include "elrom/study/settings.hpp"

namespace elrom::study {

enum class Change { better, same, worse };
[[nodiscard]] std::string_view name_of(Change change);

struct FieldVerdict {
  std::string field;
  double before = 0, after = 0;  ///< NRMSE; 0 for a truth that does not depart from the mean
  double scatter = 0;            ///< standard deviation of their difference; NaN: not known
  Change change = Change::same;
};

struct GateVerdict {
  std::string judged_on;           ///< "held-out cases" | "cross-validation"
  std::string scatter_from;        ///< "repeated runs" | "errors" | "cases" | "none"
  std::vector<std::string> cases;  ///< that judged
  std::vector<FieldVerdict> fields;
  FieldVerdict mean;                 ///< over fields; the name is empty
  std::vector<std::string> missing;  ///< fields that the present model has and the new one lacks
  bool passed = true;
  /// Names of the fields that are worse, "the mean over fields" where it is, and "no <field>" for what is
  /// missing.
  [[nodiscard]] std::vector<std::string> what_is_worse() const;
};

/// Rows of a store.
struct GateCases {
  const field::SnapshotStore& store;
  std::vector<std::size_t> building, held_out;
};

/// Cases that one of the two was trained on do not judge.
/// @return nothing where they cannot be compared: another mesh, other boundary conditions, no common field
/// @throws InputError for a bundle that cannot be read
[[nodiscard]] std::optional<GateVerdict> judge(const std::filesystem::path& present,
                                               const std::filesystem::path& candidate, const GateCases& cases,
                                               const GateSettings& settings, int n_threads);

/// {"judged_on", "scatter_from", "cases", "before", "after", "scatter", "passed", "missing": [],
/// "fields": [{"field", "before", "after", "scatter", "verdict"}]}
[[nodiscard]] std::string to_json(const GateVerdict& verdict);
/// A table, a line a field, and a sentence.
[[nodiscard]] std::string in_words(const GateVerdict& verdict);

}  // namespace elrom::study
