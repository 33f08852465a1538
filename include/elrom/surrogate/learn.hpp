#pragma once
// From a set of collisions to the bundle `collision.elrom`.
//
// The last pairs of the set (5 %) are the test: no surrogate learns from them, and its errors in the bundle
// are theirs. What learns from the others: the source's trees (document), a regressor in the frame of the
// collision (frame), nothing (exact: the law is enough).

#include <memory>
#include <optional>
#include <stop_token>

#include "elrom/base/enum_names.hpp"
#include "elrom/networks/trainer.hpp"
#include "elrom/particle/collision_errors.hpp"
#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/collision_set.hpp"
#include "elrom/surrogate/learn_chebyshev.hpp"
#include "elrom/surrogate/learn_trees.hpp"

namespace elrom::surrogate {

/// What learns inside `frame`.
enum class RegressorKind { chebyshev, trees, network };
inline constexpr base::EnumNames<RegressorKind, 3> regressor_names{"regressor",
                                                                   {{RegressorKind::chebyshev, "chebyshev"},
                                                                    {RegressorKind::trees, "trees"},
                                                                    {RegressorKind::network, "network"}}};

struct LearnSettings {
  particle::SurrogateKind surrogate = particle::SurrogateKind::frame;
  RegressorKind regressor = RegressorKind::chebyshev;
  double test = 0.05;  ///< share of the pairs that judge
  ChebyshevSettings chebyshev = {};
  TreeSettings trees = {};
  networks::Hyperparameters network = {.learning_rate = 2e-3,
                                       .n_layers = 2,
                                       .n_units = 64,
                                       .batch_size = 256,
                                       .activation = model::Activation::silu};
  networks::TrainingBudget network_budget = {.max_epochs = 300, .patience = 40};
};

struct LearnTools {
  std::shared_ptr<const TreeTrainer> trees;           ///< document, and frame with trees
  std::shared_ptr<const networks::Trainer> networks;  ///< frame with a network
  TreeStore* store = nullptr;                         ///< trials of trees; may be missing
  base::Seed seed{1};
  int n_threads = 1;
  Log* log = &silent_log();
  std::stop_token stop = {};
};

struct LearnedCollisions {
  particle::CollisionBundle bundle;  ///< its provenance lacks the files, which the caller knows
  particle::CollisionErrors errors;  ///< on the test pairs
  double seconds = 0;                ///< of learning, wall
  std::optional<LearnedDocument> document;
};

/// @param low document alone: pairs of the low range, which get trees of their own; may be missing
/// @throws UsageError for a set that cannot be learned from (too few pairs);
/// NotBuiltError for a trainer that this build lacks; Interrupted
[[nodiscard]] LearnedCollisions learn_collisions(const particle::CollisionSet& set,
                                                 const particle::CollisionSet* low,
                                                 const LearnSettings& settings, const LearnTools& tools);

}  // namespace elrom::surrogate
