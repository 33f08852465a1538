#pragma once
// Retraining: new cases of the store are taken into a trained study, with what
// earlier runs kept and the networks' plans of the earlier cases. The new bundle
// replaces model.elrom only where its error is not above the earlier one's.
//
// Errors are means over fields of the NRMSE (elrom/math/statistics.hpp), 1 =
// predicting the training mean. Times are wall seconds.
//
// Thread rule: one thread at a time; settings.n_threads() is used inside.

#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/study/settings.hpp"
#include "elrom/study/study.hpp"

namespace elrom::study {

struct RetrainReport {
  std::size_t cases_before = 0, cases_after = 0;  ///< training cases of the earlier bundle, and now
  double seconds = 0;
  std::optional<double> seconds_from_nothing;  ///< of the last run that reused no model; nothing: not known
  double error_before = 0, error_after = 0;
  /// False: the store has none, and each bundle's own cross-validation judged
  bool on_held_out_cases = false;
  bool promoted = false;  ///< the new bundle is model.elrom now
};

/// @param folder of the study; candidate.elrom is in it for the time of the comparison
/// @param compare also build from nothing, in a folder of its own, for `seconds_from_nothing`
/// @throws InputError when the folder has no model.elrom; otherwise as Study and Study::fit
[[nodiscard]] RetrainReport retrain(const std::filesystem::path& folder, const Settings& settings,
                                    const Toolbox& toolbox, Log& log, const std::stop_token& stop,
                                    bool compare = false);

/// Error of a bundle on some rows of the store, against the mean of all others; a field that does not depart
/// from that mean counts as 0. @throws InputError when bundle and store do not fit
[[nodiscard]] double held_out_error(const std::filesystem::path& bundle, const field::SnapshotStore& store,
                                    const std::vector<std::size_t>& rows);

/// Layout in data/FORMATS.md (kind "elrom-retrain").
[[nodiscard]] std::string to_json(const RetrainReport& report);

}  // namespace elrom::study
