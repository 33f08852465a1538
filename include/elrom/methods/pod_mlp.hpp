#pragma once
// Peer "pod_mlp": POD of the snapshots, and a few small networks from the boundary conditions to the modes'
// coefficients; their mean is the prediction.
//
// Every build stops early on a fold of cases of its own, so the builds' errors on those folds are a
// cross-validation. It chooses, on training cases alone: of the recipes the one of the least error, and the
// number of modes that leaves the least error of the field (a mode that is dropped errs by its energy).

#include <memory>
#include <string>
#include <vector>

#include "elrom/methods/method.hpp"
#include "elrom/networks/trainer.hpp"

namespace elrom::methods {

/// How the networks are trained.
struct PodMlpRecipe {
  networks::Hyperparameters hyperparameters;
  networks::TrainingBudget budget;
  std::string name =
      {};  ///< kept in the model, so that a retraining takes the same; empty: it tries all again
};

/// For noisy fields, where a short training is the best regulariser; and for smooth ones.
[[nodiscard]] std::vector<PodMlpRecipe> pod_mlp_recipes();

struct PodMlpOptions {
  std::size_t most_modes = 40;
  int builds = 5;  ///< each stops early on a fold of loads of its own, so that all cases build some of them
  std::vector<PodMlpRecipe> recipes = pod_mlp_recipes();
  /// 0: coefficients share one scale, so the loss is the field's own error; 1: each has unit variance, so
  /// that weak modes count as much as strong ones; between: in between.
  double equalise = 0.5;
  bool mirrors = false;           ///< mirror images of the training cases are training cases too
  std::vector<double> relevance;  ///< of each input; empty: all 1
};

/// @param trainer shared with other methods
[[nodiscard]] std::unique_ptr<Method> make_pod_mlp(std::shared_ptr<const networks::Trainer> trainer,
                                                   const PodMlpOptions& options = {});

}  // namespace elrom::methods
