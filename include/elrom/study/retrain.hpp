#pragma once
// Retraining: new cases of the store are taken into a trained study, with what
// earlier runs kept and the networks' plans of the earlier cases. The new bundle
// is a version of the study's model (versions.hpp) and takes the present one's
// place where the gate (gate.hpp) lets it pass; what each new case does to the
// error is told (case_effects.hpp).
//
// Errors are means over fields of the NRMSE (scores.hpp), 1 = predicting the
// training mean. Times are wall seconds.
//
// Thread rule: one thread at a time; settings.n_threads() is used inside.

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/study/case_effects.hpp"
#include "elrom/study/settings.hpp"
#include "elrom/study/study.hpp"

namespace elrom::study {

struct RetrainReport {
  std::size_t cases_before = 0, cases_after = 0;  ///< training cases of the present bundle, and now
  double seconds = 0;
  std::optional<double> seconds_from_nothing;  ///< of the last run that reused no model; nothing: not known
  /// The present bundle was trained on these cases with these settings: nothing was made.
  bool nothing_new = false;
  /// A version was there that was trained on these cases with these settings: the gate was asked about it
  /// again, and nothing was made.
  bool made_before = false;
  Promotion promotion = {};                 ///< its verdict: the errors before and after, field by field
  std::optional<CaseEffects> effects = {};  ///< of the new cases, where there are any
  [[nodiscard]] bool promoted() const { return !nothing_new && promotion.kind != Promotion::Kind::refused; }
};

/// @param compare also build from nothing, in a folder of its own, for `seconds_from_nothing`
/// @throws InputError when the folder has no model.elrom; otherwise as Study and Study::fit
[[nodiscard]] RetrainReport retrain(const std::filesystem::path& folder, const Settings& settings,
                                    const Toolbox& toolbox, Log& log, const std::stop_token& stop,
                                    bool compare = false);

/// Layout in data/FORMATS.md (kind "elrom-retrain").
[[nodiscard]] std::string to_json(const RetrainReport& report);

}  // namespace elrom::study
