#pragma once
// Peer "pod_mlp": POD of the snapshots, and a few small networks from the boundary conditions to the modes'
// coefficients; their mean is the prediction.

#include <memory>

#include "elrom/methods/method.hpp"
#include "elrom/networks/trainer.hpp"

namespace elrom::methods {

struct PodMlpOptions {
  std::size_t n_modes = 15;
  int builds = 5;  ///< each stops early on a fold of loads of its own, so that all cases build some of them
  networks::Hyperparameters hyperparameters{.learning_rate = 3e-3,
                                            .n_layers = 2,
                                            .n_units = 64,
                                            .batch_size = 32,
                                            .weight_decay = 1e-2,
                                            .activation = model::Activation::tanh};
  networks::TrainingBudget budget{.max_epochs = 300, .patience = 40};
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
