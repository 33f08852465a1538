#pragma once
// A method learns one field from cases and gives back a model::FieldModel; networks and peers alike.

#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/base/random.hpp"
#include "elrom/field/case_set.hpp"
#include "elrom/methods/warm_start.hpp"
#include "elrom/model/field_model.hpp"
#include "elrom/networks/workers.hpp"

namespace elrom::methods {

/// Predictions of all cases in some folds, as Method::cross_predict() gives them, and the method's key.
struct FoldPredictions {
  std::string key;
  MatrixF values;
};

struct FitContext {
  base::Seed seed{1};
  int n_threads = 1;
  Log* log = &silent_log();
  std::stop_token stop;
  const networks::Workers* workers = nullptr;  ///< other processes that train too; may be missing
  const WarmStart* warm = nullptr;             ///< where a fit may begin; nullptr: from nothing
  /// For predict_folds(): what another method said of these folds, with the same warm start; may be missing
  const FoldPredictions* known = nullptr;

  /// Trainings that run side by side: each takes one thread, here or in another process.
  [[nodiscard]] int n_trainings() const { return workers == nullptr ? n_threads : workers->n_units(); }
};

/// Groups of case rows that leave the training set together in
/// cross-validation (neighbouring loads do not leak).
using Folds = std::vector<std::vector<std::size_t>>;

/// Thread rule: const use from one thread at a time; n_threads of the context is used inside.
class Method {
 public:
  virtual ~Method() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// Of everything that a result for this field depends on
  /// beside data, rows and seed: name, options, trainer.
  [[nodiscard]] virtual std::string key(const std::string& field) const = 0;
  /// Learns from the rows `cases` of `data` alone.
  [[nodiscard]] virtual std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                               std::span<const std::size_t> cases,
                                                               const FitContext& context) const = 0;
  /// Predictions for every case in `folds` by models that did not see its fold, (n_cases, n_cells) with rows
  /// of cases in no fold left zero.
  [[nodiscard]] MatrixF cross_predict(const field::FieldData& data, const Folds& folds,
                                      const FitContext& context) const;
  /// The same for the cases in the folds of these numbers; the other folds are only learned from. The default
  /// fits once a fold; methods with a closed form override it.
  [[nodiscard]] virtual MatrixF predict_folds(const field::FieldData& data, const Folds& folds,
                                              std::span<const std::size_t> wanted,
                                              const FitContext& context) const;
};

}  // namespace elrom::methods
