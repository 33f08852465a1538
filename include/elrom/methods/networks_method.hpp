#pragma once
// The source's method for one field: screen every column, sort the columns into bands, search each band's
// hyperparameters, build each band's network several times; each build stops on a fold of cases of its own,
// so that all cases build some of them.
//
// With networks.mirrors they learn the symmetric part of the field over its scale, on one column of each
// orbit of the mirrors; scale and asymmetry are learned as by the kernel method. Bands are then of those
// columns.
//
// With a warm start plan and scale are those of the cases known before, the asymmetry is learned from all,
// and every network of the model goes on from the one that was trained on the known ones. Cross-validation
// trains nothing: its networks are those of the known cases, and a further case is predicted by those that
// did not see its neighbours in load either. They lack the further cases, so that the error is a little too
// large, never too small. What was known before is taken from the cache, or made again.

#include <memory>
#include <string>
#include <vector>

#include "elrom/io/stage_cache.hpp"
#include "elrom/methods/method.hpp"
#include "elrom/model/banded_networks.hpp"
#include "elrom/networks/stages.hpp"

namespace elrom::methods {

/// What screening, banding and search decided for one field.
struct NetworkPlan {
  std::vector<networks::Band> bands;
  /// Of each band, the best and those nearly as good; its builds take them in turn.
  std::vector<std::vector<networks::Hyperparameters>> hyperparameters;
  networks::ScreeningResult screening;
};

class NetworksMethod final : public Method {
 public:
  /// @param trainer may be missing for screening alone @param cache, trials may be missing: nothing is kept.
  /// All must outlive the method.
  NetworksMethod(networks::Settings settings, std::shared_ptr<const networks::Trainer> trainer,
                 const io::StageCache* cache = nullptr, networks::TrialStore* trials = nullptr);

  [[nodiscard]] std::string name() const override { return "networks"; }
  [[nodiscard]] std::string key(const std::string& field) const override;
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const override;
  /// Bands and hyperparameters are those of all cases in the folds; the networks of a fold have not seen its
  /// cases. At most three builds a band. The asymmetry is taken from what the kernel method said of the
  /// folds, where that is known.
  [[nodiscard]] MatrixF predict_folds(const field::FieldData& data, const Folds& folds,
                                      std::span<const std::size_t> wanted,
                                      const FitContext& context) const override;

  /// The stages before the fit; each from the cache where it is valid.
  [[nodiscard]] networks::ScreeningResult screen_field(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const;
  [[nodiscard]] NetworkPlan plan(const field::FieldData& data, std::span<const std::size_t> cases,
                                 const FitContext& context) const;

  /// Later calls take bands and hyperparameters from here instead of screening and searching.
  void keep_plan(const std::string& field, NetworkPlan plan);
  /// The closed-form screen on the same records, whatever screen.method says; cheap, not kept.
  [[nodiscard]] networks::ScreeningResult fast_screen(const field::FieldData& data,
                                                      std::span<const std::size_t> cases,
                                                      const FitContext& context) const;

  /// Columns of the field for each column of a plan's bands.
  [[nodiscard]] std::size_t columns_each(const field::FieldData& data) const;

 private:
  /// What networks learn of a field: all of it, or its symmetric part.
  class Learned;
  [[nodiscard]] bool has_asymmetry(const field::FieldData& data) const;
  [[nodiscard]] MatrixF asymmetry_in_folds(const field::FieldData& data, const Folds& folds,
                                           std::span<const std::size_t> wanted,
                                           const FitContext& context) const;
  [[nodiscard]] networks::RecordSource screened_records(const field::FieldData& data,
                                                        std::span<const std::size_t> cases,
                                                        const FitContext& context) const;
  /// Records of some cases, and of those of them that were known.
  struct Records;
  [[nodiscard]] networks::ScreeningResult screen_learned(const field::FieldData& data,
                                                         std::span<const std::size_t> cases,
                                                         const FitContext& context) const;
  [[nodiscard]] NetworkPlan plan_learned(const field::FieldData& data, std::span<const std::size_t> cases,
                                         const networks::RecordSource& records,
                                         const FitContext& context) const;
  [[nodiscard]] networks::TrainingResult train(const networks::BuildStage& stage,
                                               const FitContext& context) const;
  [[nodiscard]] std::vector<model::Submodel> build(const field::FieldData& data, const NetworkPlan& plan,
                                                   const Records& records, int n_builds,
                                                   const FitContext& context, int n_threads) const;
  [[nodiscard]] std::unique_ptr<model::FieldModel> assemble(const field::FieldData& data,
                                                            const networks::RecordSet& set,
                                                            std::vector<model::Submodel> submodels) const;
  [[nodiscard]] networks::FieldSettings settings_of(const field::FieldData& data) const {
    return networks::settings_of_field(settings_, data.info.name);
  }

  networks::Settings settings_;
  std::shared_ptr<const networks::Trainer> trainer_;
  const io::StageCache* cache_;
  io::StageCache no_cache_;
  networks::TrialStore* trials_;
  std::unique_ptr<Method> kernel_, asymmetry_;
  std::map<std::string, NetworkPlan> kept_;
};

}  // namespace elrom::methods
