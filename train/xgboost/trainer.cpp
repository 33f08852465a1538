#include "elrom/xgboost/trainer.hpp"

#include <cmath>
#include <limits>

#include "booster.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::xgboost {
namespace {

using surrogate::GrownTrees;
using surrogate::TreeBudget;
using surrogate::TreeHyperparameters;
using surrogate::TreeProblem;
using surrogate::TreeRecords;

// Targets as XGBoost gets them: of mean 0 and deviation 1, so that reg_alpha means the same for any of them.
struct Scale {
  double mean, deviation;
  explicit Scale(const Eigen::ArrayXd& targets)
      : mean(targets.mean()), deviation(std::sqrt((targets - mean).square().mean())) {
    if (!(deviation > 1e-12 * std::abs(mean))) deviation = 1;
  }
  [[nodiscard]] Eigen::ArrayXd apply(const Eigen::ArrayXd& targets) const {
    return (targets - mean) / deviation;
  }
};

void check_records(const TreeRecords& records) {
  check(records.targets.size() == records.inputs.rows() &&
            (records.weights.size() == 0 || records.weights.size() == records.inputs.rows()),
        "trees: a target and a weight for each record");
  if (!records.targets.allFinite())
    throw InputError(Problem{.what = "targets of trees with numbers that are not finite"});
}

std::map<std::string, std::string> parameters(const TreeHyperparameters& h, base::Seed seed) {
  return {{"booster", "gbtree"},
          {"tree_method", "hist"},
          {"objective", "reg:squarederror"},
          {"base_score", "0"},
          {"nthread", "1"},
          {"verbosity", "0"},
          {"seed", std::to_string(seed.value() & 0x7fffffffU)},
          // The library's generator is shared by a thread's trainings; each round begins its own.
          {"seed_per_iteration", "1"},
          {"max_depth", std::to_string(h.max_depth)},
          {"learning_rate", base::number(h.learning_rate)},
          {"colsample_bytree", base::number(h.colsample_bytree)},
          {"alpha", base::number(h.reg_alpha)}};
}

class Validation {
 public:
  Validation(const TreeRecords& records, const Scale& scale)
      : targets_(scale.apply(records.targets)), weights_(records.weights) {
    if (weights_.size() == 0) weights_ = Eigen::ArrayXd::Ones(targets_.size());
  }
  [[nodiscard]] double mse(std::span<const float> predicted) const {
    const Eigen::Map<const Eigen::ArrayXf> values(predicted.data(),
                                                  static_cast<Eigen::Index>(predicted.size()));
    return ((values.cast<double>() - targets_).square() * weights_).sum() / weights_.sum();
  }

 private:
  Eigen::ArrayXd targets_, weights_;
};

class XgboostTrainer final : public surrogate::TreeTrainer {
 public:
  [[nodiscard]] std::string name() const override { return "xgboost"; }

  [[nodiscard]] GrownTrees train(const TreeProblem& problem, const TreeHyperparameters& hyperparameters,
                                 const TreeBudget& budget, base::Seed seed,
                                 networks::TrainingMonitor* monitor,
                                 const std::stop_token& stop) const override {
    check_records(problem.train);
    check_records(problem.validation);
    const Scale scale(problem.train.targets);
    Matrix train(problem.train.inputs), validation(problem.validation.inputs);
    train.set("label", scale.apply(problem.train.targets));
    if (problem.train.weights.size() > 0) train.set("weight", problem.train.weights);
    const Validation judge(problem.validation, scale);
    Booster booster(train, validation, parameters(hyperparameters, seed));

    GrownTrees grown;
    grown.validation_mse = std::numeric_limits<double>::max();
    int best_round = 0;
    for (int round = 1; round <= hyperparameters.n_estimators; ++round) {
      if (stop.stop_requested()) throw Interrupted("stopped on request");
      booster.grow(round - 1);
      grown.rounds = round;
      const double mse = judge.mse(booster.predict(validation));
      if (!std::isfinite(mse)) {
        grown.diverged = true;
        return grown;
      }
      if (mse < grown.validation_mse) grown.validation_mse = mse, best_round = round;
      if (monitor != nullptr && !monitor->keep_going(round, mse)) {
        grown.pruned = true;
        return grown;
      }
      if (round - best_round >= budget.patience) break;
    }
    if (budget.keep_trees) take(booster.trees(best_round), scale, grown);
    return grown;
  }

 private:
  static void take(Booster::Flat flat, const Scale& scale, GrownTrees& grown) {
    for (auto& node : flat.nodes)
      if (node.feature < 0) node.value = static_cast<float>(node.value * scale.deviation);
    flat.group.base = scale.mean + scale.deviation * flat.group.base;
    grown.nodes = std::move(flat.nodes);
    grown.group = std::move(flat.group);
  }
};

}  // namespace

std::shared_ptr<const surrogate::TreeTrainer> make_tree_trainer() {
  return std::make_shared<XgboostTrainer>();
}

}  // namespace elrom::xgboost
