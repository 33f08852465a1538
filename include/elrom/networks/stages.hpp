#pragma once
// The kept stages of the networks of a field (io/stage_cache.hpp):
// each is given the settings that it reads and no others.

#include "elrom/base/log.hpp"
#include "elrom/io/stage_cache.hpp"
#include "elrom/networks/banding.hpp"
#include "elrom/networks/records.hpp"
#include "elrom/networks/trainer.hpp"
#include "elrom/networks/trial_store.hpp"
#include "elrom/networks/workers.hpp"

namespace elrom::networks {

/// What may differ from run to run without a change in what comes out.
struct StageContext {
  int n_threads = 1;
  int n_trainings = 1;  ///< side by side, here and in other processes
  Log* log = &silent_log();
  std::stop_token stop = {};
  const Workers* workers = nullptr;       ///< other processes that train too; may be missing
  TrialStore* trials = nullptr;           ///< may be missing
  std::filesystem::path checkpoint = {};  ///< of a build; empty: none
};

/// The settings of a field's networks, stage by stage: what is made of the study's for one field.
struct FieldSettings {
  RecordOptions screened;  ///< the source's inputs, whatever the networks get
  ScreenSettings screen;
  PartRule parts;
  BandSettings bands;
  RecordOptions records;
  SearchSettings search;
  model::Activation activation = model::Activation::relu;
  FitSettings fit;
  int epoch_records = 0;
  bool anneal = false;
  bool average = false;
  bool symmetric = false;  ///< learn the symmetric part over its scale, on one column of each orbit
};
/// What a stage would not read (the closed-form screen's settings beside
/// networks, ranges that are not searched) is at its default.
[[nodiscard]] FieldSettings settings_of_field(const Settings& settings, const std::string& field);

/// How well a default network learns each column. Read the file with screening_of().
struct ScreenStage {
  static constexpr const char* stage = "screen";
  static constexpr int version = 1;
  std::string field;
  const RecordSource* records;
  ScreenSettings settings;
  base::Seed seed;
  [[nodiscard]] io::TensorFile compute(const StageContext& context) const;
};

/// A band's best hyperparameters and those nearly as good. Read the file with hyperparameters_of().
struct SearchStage {
  static constexpr const char* stage = "search";
  static constexpr int version = 2;
  std::string field;
  const RecordSource* records;
  Band band;
  SearchSettings settings;
  int epoch_records;
  bool anneal;
  model::Activation activation;
  const Trainer* trainer;
  base::Seed seed;
  [[nodiscard]] io::TensorFile compute(const StageContext& context) const;
};

/// One network of a band. Read the file with training_of().
struct BuildStage {
  static constexpr const char* stage = "build";
  static constexpr int version = 2;
  std::string name;  ///< for warnings: field, band and number
  const RecordSource* records;
  BuildNumber number;  ///< which records stop it
  Band band;
  Hyperparameters hyperparameters;
  TrainingBudget budget;
  const Trainer* trainer;
  base::Seed seed;
  MatrixF start = {};  ///< weights to begin at: TrainingProblem::start
  [[nodiscard]] io::TensorFile compute(const StageContext& context) const;
};

}  // namespace elrom::networks
