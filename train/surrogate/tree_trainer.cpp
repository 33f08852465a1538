#include "elrom/surrogate/tree_trainer.hpp"

#include "elrom/base/error.hpp"

namespace elrom::surrogate {
namespace {

class MissingTrainer final : public TreeTrainer {
 public:
  [[nodiscard]] std::string name() const override { return "none"; }
  [[nodiscard]] GrownTrees train(const TreeProblem&, const TreeHyperparameters&, const TreeBudget&,
                                 base::Seed, networks::TrainingMonitor*,
                                 const std::stop_token&) const override {
    throw NotBuiltError(Problem{.what = "trees are grown by XGBoost, which this build left out",
                                .advice = "install libxgboost-dev and build with -DELROM_XGBOOST=ON"});
  }
};

}  // namespace

std::shared_ptr<const TreeTrainer> missing_tree_trainer() { return std::make_shared<MissingTrainer>(); }

}  // namespace elrom::surrogate
