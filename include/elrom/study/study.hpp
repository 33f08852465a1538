#pragma once
// A study: a folder with study.toml in, model.elrom and its peers out. Every stage keeps its results under
// the digest of its inputs (stage_cache.hpp), so a second run, or one after a crash, redoes only what is not
// valid any more.
//
//   STUDY/resolved.toml   settings as used
//   STUDY/split.json      cases by part
//   STUDY/model.elrom     the model that answers: a link into STUDY/models (versions.hpp)
//   STUDY/peers/*.elrom   peers on the same cases, each a bundle
//   STUDY/stages/*        kept results
//   STUDY/search.sqlite   every trial
//   STUDY/timing.json     seconds a stage

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/io/stage_cache.hpp"
#include "elrom/methods/method.hpp"
#include "elrom/methods/networks_method.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/networks/banding.hpp"
#include "elrom/networks/trainer.hpp"
#include "elrom/study/gate.hpp"
#include "elrom/study/settings.hpp"

namespace elrom::study {

/// What a study builds with beside its own methods; filled by the program.
struct Toolbox {
  std::shared_ptr<const networks::Trainer> trainer;  ///< nullptr: LibTorch was left out of this build
  const networks::Workers* workers =
      nullptr;  ///< other processes that train too; may be missing, else outlives the study
};

/// What a run found for one field.
struct FieldOutcome {
  std::string field, method;
  double cross_validated_nrmse = 0;   ///< against the training mean, 1 = no skill
  std::vector<networks::Band> bands;  ///< screen and search only
  std::size_t columns_each = 1;       ///< of the field, for each column of a band
};

/// What became of a model that was made for the study.
struct Promotion {
  enum class Kind { first, unchanged, promoted, refused };
  Kind kind = Kind::first;
  int number = 0;  ///< version of the model; of the present one where it is unchanged
  std::optional<GateVerdict> verdict = {};  ///< where there was a present model to compare with
};

/// Thread rule: one thread at a time; settings.n_threads() is used inside.
class Study {
 public:
  /// Locks the folder. @throws UsageError when another process works in it, InputError on a bad store
  Study(std::filesystem::path folder, Settings settings, Toolbox toolbox, Log& log, std::stop_token stop);
  ~Study();

  /// The stages of the networks, one by one.
  std::vector<FieldOutcome> screen();
  std::vector<FieldOutcome> search();
  /// The model alone. @param bundle where to; empty: a version of the study's model, which takes the present
  /// one's place through the gate (gate.hpp), unless it is the present one already
  std::vector<FieldOutcome> fit(const std::filesystem::path& bundle = {});
  /// The model, as fit() makes it, and every peer; those stay as they are where the model is refused.
  std::vector<FieldOutcome> run();
  /// Of the last run() or fit() without a path.
  [[nodiscard]] const Promotion& promotion() const;

  [[nodiscard]] const Settings& settings() const;
  [[nodiscard]] const field::SnapshotStore& store() const;
  [[nodiscard]] const field::CaseSet& cases() const;
  /// Held-out rows of the store.
  [[nodiscard]] const std::vector<std::size_t>& held_out() const;
  /// Rows that the gate goes by.
  [[nodiscard]] GateCases gate_cases() const;
  /// A version, other than the present one, that was trained on these very cases with these settings;
  /// nothing: there is none.
  [[nodiscard]] std::optional<int> version_of_these() const;
  /// Asks the gate about such a version, as fit() does about what it made: promotion() tells.
  void judge_again(int version);
  /// Whether a bundle was trained on these very cases with these settings: nothing new could be learned.
  [[nodiscard]] bool is_of_this_study(const model::BundleInfo& bundle) const;
  /// Retraining: fit() begins at this bundle where a method can, and tries those candidates again that had a
  /// part in it or were near to one. Networks take bands, hyperparameters and first weights from those of its
  /// cases, where the fast screen says that the cases since then left the bands as they were. What comes out
  /// depends on the bundle's digest. @throws InputError
  void begin_at(const std::filesystem::path& bundle);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Names and patterns of the cases that a study never builds with: the settings', else those of the store's
/// furnace. That there are none, or that one of the furnace's matches no case, is told.
/// @throws UsageError for one of the settings' that matches no case
[[nodiscard]] std::vector<std::string> held_out_patterns(const field::SnapshotStore& store,
                                                         const Settings& settings, Log& log);

/// Cases of a store that a study builds with: its held-out cases left out, its mirrors resolved.
/// Mirrors that the settings name must resolve; those of the store's furnace are used where they do.
[[nodiscard]] field::CaseSet study_cases(const field::SnapshotStore& store, const Settings& settings,
                                         const std::vector<std::size_t>& rows, Log& log);

}  // namespace elrom::study
