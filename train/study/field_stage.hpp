#pragma once
// One method on one field as a stage: the model, its prediction intervals and its cross-validated error.
// Internal to the study.

#include <nlohmann/json_fwd.hpp>

#include "elrom/io/stage_cache.hpp"
#include "elrom/methods/method.hpp"
#include "elrom/model/uncertainty.hpp"

namespace elrom::study {

struct FieldStage {
  io::TensorFile file;  ///< model under "model", intervals under "uncertainty"

  [[nodiscard]] std::shared_ptr<const model::FieldModel> model() const;
  [[nodiscard]] std::shared_ptr<const model::Uncertainty> uncertainty() const;  ///< nullptr: fitted without
  [[nodiscard]] double nrmse() const;  ///< cross-validated; NaN: fitted without
  /// What it took when it was fitted, cache hits of later runs notwithstanding; not part of a bundle, whose
  /// bytes repeat.
  [[nodiscard]] double seconds() const;
  /// {"method", "nrmse", "nrmse_by_band", "candidates": [{"name", "nrmse", "weight"}]}, for the bundle.
  [[nodiscard]] const std::string& accuracy() const { return file.text("accuracy"); }
};

struct FieldStageRequest {
  std::string name;                                ///< "auto", "pod_gp" ...
  std::vector<const methods::Method*> candidates;  ///< one, or for "auto" those it chooses among
  const field::FieldData& data;
  std::vector<double> band_edges;  ///< for "auto": see AutoOptions
  std::size_t n_folds = 0;         ///< cross-validation for error and intervals; 0: none
  std::string settings_digest;     ///< of every setting that the result depends on
};

/// From the cache, or fitted now on all cases of the data.
[[nodiscard]] FieldStage fit_field(const FieldStageRequest& request, const io::StageCache& cache,
                                   const methods::FitContext& context);

}  // namespace elrom::study
