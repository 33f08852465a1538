#pragma once
// The seam between learning and the library that grows boosted trees: the search is tested with a fake
// trainer, and XGBoost stays in train/xgboost.

#include <array>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/random.hpp"
#include "elrom/networks/trainer.hpp"
#include "elrom/particle/trees.hpp"

namespace elrom::surrogate {

/// What is searched (networks/hyperparameters.hpp): the source's five.
struct TreeHyperparameters {
  int n_estimators =
      300;  ///< rounds of boosting, one tree each; fewer when the validation error stops falling
  int max_depth = 6;
  double learning_rate = 0.1;
  double colsample_bytree = 1;  ///< share of the inputs that a tree sees
  double reg_alpha = 0;         ///< L1, of standardised targets
  bool operator==(const TreeHyperparameters&) const = default;

  static constexpr std::array names{"n_estimators", "max_depth", "learning_rate", "colsample_bytree",
                                    "reg_alpha"};
  static constexpr const char* trial_table = "tree_trials";
};

/// Records of one output.
struct TreeRecords {
  particle::Table inputs;  ///< (n, k)
  Eigen::ArrayXd targets;  ///< (n)
  Eigen::ArrayXd weights;  ///< (n), positive; empty: all count alike
};

/// Trees are grown on `train`; `validation` stops them.
struct TreeProblem {
  TreeRecords train, validation;
};

struct TreeBudget {
  int patience = 20;       ///< rounds without a better validation error before stopping
  bool keep_trees = true;  ///< a trial of the search asks for its error alone
};

struct GrownTrees {
  std::vector<particle::TreeNode> nodes;  ///< up to the best round
  particle::TreeGroup group;              ///< roots count from the first of these nodes
  double validation_mse = 0;              ///< of the best round; of the targets divided by their deviation
  int rounds = 0;                         ///< grown; the best one may be earlier
  bool pruned = false;
  bool diverged = false;  ///< an error that was not finite: no trees

  operator networks::TrialOutcome() const { return {validation_mse, rounds, pruned, diverged}; }
};

/// Thread rule: train() may run on several threads at a time; each call uses one thread.
class TreeTrainer {
 public:
  virtual ~TreeTrainer() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// The same arguments give the same trees. @param monitor told after each round; may be missing
  /// @throws InputError for empty tables or numbers that are not finite; Interrupted on `stop`
  [[nodiscard]] virtual GrownTrees train(const TreeProblem& problem,
                                         const TreeHyperparameters& hyperparameters, const TreeBudget& budget,
                                         base::Seed seed, networks::TrainingMonitor* monitor,
                                         const std::stop_token& stop = {}) const = 0;
};

/// Stands for a trainer in a build without one: train() says so. @throws NotBuiltError from train()
[[nodiscard]] std::shared_ptr<const TreeTrainer> missing_tree_trainer();

}  // namespace elrom::surrogate
