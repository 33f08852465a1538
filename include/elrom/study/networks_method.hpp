#pragma once
// The source's method for one field: screen every column, sort the columns into bands, search each band's
// hyperparameters, build each band's network several times.

#include <memory>
#include <string>
#include <vector>

#include "elrom/model/banded_networks.hpp"
#include "elrom/study/banding.hpp"
#include "elrom/study/method.hpp"
#include "elrom/study/settings.hpp"
#include "elrom/study/stage_cache.hpp"
#include "elrom/study/trainer.hpp"
#include "elrom/study/trial_store.hpp"

namespace elrom::study {

struct RecordOptions;
struct RecordSet;

/// What screening, banding and search decided for one field.
struct NetworkPlan {
  std::vector<Band> bands;
  std::vector<Hyperparameters> hyperparameters;  ///< of each band
  ScreeningResult screening;
};

class NetworksMethod final : public Method {
 public:
  /// @param trainer may be missing for screening alone @param cache, trials may be missing: nothing is kept.
  /// All must outlive the method.
  NetworksMethod(Settings settings, std::shared_ptr<const Trainer> trainer, const StageCache* cache = nullptr,
                 TrialStore* trials = nullptr);

  [[nodiscard]] std::string name() const override { return "networks"; }
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const override;
  /// Bands and hyperparameters are those of all cases in the folds; the networks of a fold have not seen its
  /// cases. At most two builds a band.
  [[nodiscard]] MatrixF cross_predict(const FieldData& data, const Folds& folds,
                                      const FitContext& context) const override;

  /// The stages before the fit; each from the cache where it is valid.
  [[nodiscard]] ScreeningResult screen_field(const FieldData& data, std::span<const std::size_t> cases,
                                             const FitContext& context) const;
  [[nodiscard]] NetworkPlan plan(const FieldData& data, std::span<const std::size_t> cases,
                                 const FitContext& context) const;

  /// Later calls take bands and hyperparameters from here instead of screening and searching: retraining when
  /// a few cases were added.
  void keep_plan(const std::string& field, NetworkPlan plan);
  void forget_plan(const std::string& field) { kept_.erase(field); }
  /// The closed-form screen on the same records, whatever screen.method says; cheap, not kept.
  [[nodiscard]] ScreeningResult fast_screen(const FieldData& data, std::span<const std::size_t> cases,
                                            const FitContext& context) const;

 private:
  [[nodiscard]] std::vector<Part> split(const FieldData& data, std::span<const std::size_t> cases,
                                        const FitContext& context) const;
  [[nodiscard]] RecordSet screening_records(const FieldData& data, std::span<const std::size_t> cases,
                                            const FitContext& context) const;
  [[nodiscard]] RecordOptions record_options(const std::string& field) const;
  [[nodiscard]] std::vector<model::Submodel> build(const FieldData& data, const NetworkPlan& plan,
                                                   const RecordSet& set, const std::string& digest,
                                                   int n_builds, const FitContext& context,
                                                   int n_threads) const;
  [[nodiscard]] std::unique_ptr<model::FieldModel> assemble(const FieldData& data, RecordSet set,
                                                            std::vector<model::Submodel> submodels) const;

  Settings settings_;
  std::shared_ptr<const Trainer> trainer_;
  const StageCache* cache_;
  StageCache no_cache_;
  TrialStore* trials_;
  std::map<std::string, NetworkPlan> kept_;
};

}  // namespace elrom::study
