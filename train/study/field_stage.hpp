#pragma once
// One method on one field as a stage: the model, its prediction intervals and its cross-validated error.
// Internal to the study.

#include <nlohmann/json_fwd.hpp>

#include "earlier_model.hpp"
#include "elrom/io/stage_cache.hpp"
#include "elrom/methods/method.hpp"
#include "elrom/model/uncertainty.hpp"
#include "timing.hpp"

namespace elrom::study {

struct FieldStage {
  io::TensorFile file;  ///< model under "model", intervals under "uncertainty"

  [[nodiscard]] std::shared_ptr<const model::FieldModel> model() const;
  [[nodiscard]] std::shared_ptr<const model::Uncertainty> uncertainty() const;  ///< nullptr: fitted without
  [[nodiscard]] double nrmse() const;  ///< cross-validated; NaN: fitted without
  /// What it took when it was fitted, cache hits of later runs notwithstanding; not part of a bundle, whose
  /// bytes repeat.
  [[nodiscard]] double seconds() const;
  /// What each method that took part cost then: wall and processor seconds of its fit, its cross-validation
  /// and its share of the intervals. Empty in files of programs that did not keep it.
  [[nodiscard]] std::map<std::string, MethodCost> costs() const;
  /// {"method", "nrmse", "nrmse_by_band", "candidates": [{"name", "nrmse", "weight"}], "squared_errors"}, for
  /// the bundle; the last by case, summed over cells, each case by a model that did not see it.
  [[nodiscard]] const std::string& accuracy() const { return file.text("accuracy"); }
};

/// Folds of the models that intervals are scored by. Of few cases twice as many as methods compete in,
/// because a model that misses as many cases as those do errs more than the one that will answer.
[[nodiscard]] constexpr std::size_t interval_folds(std::size_t n_folds, std::size_t n_cases) {
  return n_cases < 128 ? 2 * n_folds : n_folds;
}

/// A method as an input of a stage: with what it depends on for one field.
struct Candidate {
  const methods::Method* method;
  std::string field;
  [[nodiscard]] std::string key() const { return method->key(field); }
};

/// Fitted on all cases of the data. Read the file as a FieldStage.
struct ModelStage {
  static constexpr const char* stage = "model";
  static constexpr int version = 4;
  std::string name;                   ///< "auto", "pod_gp" ...
  std::vector<Candidate> candidates;  ///< one, or for "auto" those it chooses among
  const field::FieldData* data;
  std::vector<double> band_edges;  ///< for "auto": see AutoOptions
  std::size_t n_folds;             ///< cross-validation for error and intervals; 0: none
  base::Seed seed;
  methods::WarmStart warm;        ///< without a model: from nothing
  std::vector<LeftOut> left_out;  ///< candidates that are only told of
  [[nodiscard]] io::TensorFile compute(const methods::FitContext& context) const;
};

struct FieldStageRequest {
  std::string name;
  std::vector<const methods::Method*> candidates;
  const field::FieldData& data;
  std::vector<double> band_edges;
  std::size_t n_folds = 0;
  methods::WarmStart warm = {};
  std::vector<LeftOut> left_out = {};
};

/// From the cache, or fitted now. Candidates that are left out do not take part.
[[nodiscard]] FieldStage fit_field(const FieldStageRequest& request, const io::StageCache& cache,
                                   const methods::FitContext& context);

}  // namespace elrom::study
