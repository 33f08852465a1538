#pragma once
// Boosted trees grown by XGBoost's C interface and taken out as flat ones.

#include <memory>

#include "elrom/surrogate/tree_trainer.hpp"

namespace elrom::xgboost {

/// Histograms, squared error, one thread a training.
[[nodiscard]] std::shared_ptr<const surrogate::TreeTrainer> make_tree_trainer();

}  // namespace elrom::xgboost
