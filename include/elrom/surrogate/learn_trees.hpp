#pragma once
// Boosted trees learned from tables of records, their hyperparameters searched; and the source's surrogate of
// collisions made of them.
//
// One search serves all outputs of a table: its trials grow the trees of one output on a sample of the records
// and are pruned by successive halving (networks/search.hpp; an epoch is a round). What it finds then grows the
// trees of every output, on all records, side by side.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/networks/search.hpp"
#include "elrom/particle/collision_set.hpp"
#include "elrom/particle/document_model.hpp"
#include "elrom/surrogate/tree_trainer.hpp"

namespace elrom::surrogate {

using TreeStore = networks::TrialStoreOf<TreeHyperparameters>;

struct TreeSettings {
  std::string algorithm = "direct";  ///< of NLopt; networks/settings.hpp
  int trials = 50;                   ///< 0: `fixed` is taken without a search
  bool prune = true;
  std::size_t searched_output = 0;      ///< whose trees the trials grow
  std::size_t search_records = 15'000;  ///< that trials learn from and are judged by, at most
  int patience = 20;                    ///< rounds without a better validation error before growing stops
  double validation = 0.25;             ///< share of the records that stops the growing
  std::vector<double> n_estimators{50, 500};
  std::vector<double> max_depth{3, 10};
  std::vector<double> learning_rate{0.03, 0.5};
  std::vector<double> colsample_bytree{0.5, 1};
  std::vector<double> reg_alpha{1e-3, 10};
  TreeHyperparameters fixed = {};
  /// Of the trees that are kept, as many times what was found: all records bear more rounds than a sample.
  double final_rounds = 2;
};

struct TreeContext {
  std::string name = "trees";  ///< for people: "document, slow pairs"
  base::Seed seed{1};
  int n_threads = 1;
  TreeStore* store = nullptr;  ///< may be missing: nothing is kept
  Log* log = &silent_log();
  std::stop_token stop = {};
};

/// What was learned and how.
struct LearnedTrees {
  std::unique_ptr<particle::Trees> trees;
  TreeHyperparameters hyperparameters;
  std::vector<double> validation_mse;  ///< one an output, of the targets divided by their deviation
  std::vector<int> rounds;             ///< trees of each output
  std::size_t n_trials = 0, n_replayed = 0;
  double search_seconds = 0, fit_seconds = 0;
};

/// @param inputs (n, k) @param targets (n, m): m groups of trees @param weights (n) of the records; empty: alike
/// The same arguments give the same trees, whatever the number of threads and with or without stored trials.
/// @throws InputError for fewer than ten records, or numbers that are not finite; Interrupted
[[nodiscard]] LearnedTrees learn_trees(const particle::Table& inputs, const particle::Table& targets,
                                       const Eigen::ArrayXd& weights, const TreeSettings& settings,
                                       const TreeTrainer& trainer, const TreeContext& context);

/// The source's protocol (the files' `document`).
struct DocumentSettings {
  double test = 0.05;  ///< share of the pairs that judges, never learned from
  TreeSettings trees = {};
};

/// One range of speeds.
struct DocumentRange {
  std::vector<std::size_t> test;  ///< pairs of the set that judged
  std::array<double, 6> mae{};    ///< on them, m/s: of sphere 1, then of sphere 2, by the model of this range
  std::array<double, 6> median_relative{};  ///< median of |error| / |value|
  TreeHyperparameters hyperparameters;
  std::array<int, 6> rounds{};
  double search_seconds = 0, fit_seconds = 0;
};

struct LearnedDocument {
  std::shared_ptr<const particle::DocumentModel> model;
  DocumentRange full;
  std::optional<DocumentRange> low;
};

/// Six velocity components to six, standardised on the training pairs; of each range a search (on the first
/// component of sphere 1) and six groups of trees. The two ranges are learned side by side.
/// @param low pairs of the low range, drawn apart (in a set up to 20 m/s one pair in a hundred is slow); its
/// protocol's greatest speed is where the model switches; may be missing
[[nodiscard]] LearnedDocument learn_document(const particle::CollisionSet& full,
                                             const particle::CollisionSet* low,
                                             const DocumentSettings& settings, const TreeTrainer& trainer,
                                             const TreeContext& context);

}  // namespace elrom::surrogate
