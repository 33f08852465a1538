#include "elrom/xgboost/trainer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"

namespace elrom::xgboost {
namespace {

using particle::Table;
using surrogate::GrownTrees;
using surrogate::TreeProblem;
using surrogate::TreeRecords;

// Large numbers far from zero, with noise that no tree can learn.
TreeRecords records(Eigen::Index n, std::uint64_t seed, double noise = 0.3) {
  base::Random random{base::Seed(seed)};
  TreeRecords result{Table(n, 3), Eigen::ArrayXd(n), {}};
  for (auto& x : result.inputs.reshaped()) x = random.normal();
  for (Eigen::Index i = 0; i < n; ++i)
    result.targets[i] =
        1e4 + 500 * (std::sin(2 * result.inputs(i, 0)) + result.inputs(i, 1) + noise * random.normal());
  return result;
}

TreeProblem problem() { return {records(2000, 1), records(700, 2)}; }

double mse_of(const GrownTrees& grown, const TreeProblem& problem) {
  const auto& [inputs, targets, weights] = problem.validation;
  Table predicted(inputs.rows(), 1);
  particle::Trees(3, grown.nodes, {grown.group}).evaluate(inputs, predicted);
  const double deviation = std::sqrt((problem.train.targets - problem.train.targets.mean()).square().mean());
  return ((predicted.col(0) - targets) / deviation).square().mean();
}

class Counter final : public networks::TrainingMonitor {
 public:
  explicit Counter(int last = 1 << 30) : last_(last) {}
  bool keep_going(int epoch, double validation_mse) override {
    EXPECT_EQ(epoch, static_cast<int>(values.size()) + 1);
    values.push_back(validation_mse);
    return epoch < last_;
  }
  std::vector<double> values;

 private:
  int last_;
};

TEST(XgboostTrainer, TheErrorItTellsIsThatOfTheTreesItGives) {
  const auto data = problem();
  const auto grown = make_tree_trainer()->train(data, {.n_estimators = 60}, {}, base::Seed(1), nullptr);

  EXPECT_NEAR(mse_of(grown, data), grown.validation_mse, 1e-5 * grown.validation_mse);
  EXPECT_LT(grown.validation_mse, 0.15) << "of 1; noise alone leaves 0.06";
}

TEST(XgboostTrainer, GrowingStopsAndKeepsTheBestRound) {
  const auto data = problem();
  Counter counter;

  const auto grown = make_tree_trainer()->train(data, {.n_estimators = 1000, .learning_rate = 0.3},
                                                {.patience = 7}, base::Seed(1), &counter);

  const auto best =
      std::min_element(counter.values.begin(), counter.values.end()) - counter.values.begin() + 1;
  EXPECT_EQ(static_cast<std::ptrdiff_t>(grown.group.roots.size()), best);
  EXPECT_EQ(grown.rounds, best + 7);
  EXPECT_EQ(grown.validation_mse, counter.values[static_cast<std::size_t>(best) - 1]);
  EXPECT_NEAR(mse_of(grown, data), grown.validation_mse, 1e-5 * grown.validation_mse);
}

TEST(XgboostTrainer, AMonitorPrunes) {
  Counter counter(5);
  const auto grown = make_tree_trainer()->train(problem(), {}, {}, base::Seed(1), &counter);

  EXPECT_TRUE(grown.pruned);
  EXPECT_EQ(grown.rounds, 5);
  EXPECT_TRUE(grown.nodes.empty());
}

TEST(XgboostTrainer, SameArgumentsSameTreesOnAnyThread) {
  const auto data = problem();
  const auto trainer = make_tree_trainer();
  const surrogate::TreeHyperparameters h{.n_estimators = 15, .colsample_bytree = 0.4};
  std::vector<GrownTrees> grown(4);
  base::parallel_for(4, 3, [&](std::size_t i, int) {
    grown[i] = trainer->train(data, h, {}, base::Seed(i == 3 ? 6 : 5), nullptr);
  });
  EXPECT_EQ(grown[0].nodes, grown[1].nodes);
  EXPECT_EQ(grown[0].nodes, grown[2].nodes);
  EXPECT_NE(grown[0].nodes, grown[3].nodes) << "another seed draws other columns";
}

TEST(XgboostTrainer, EachHyperparameterChangesTheTrees) {
  const auto data = problem();
  const auto trainer = make_tree_trainer();
  const auto nodes = [&](surrogate::TreeHyperparameters h) {
    return trainer->train(data, h, {}, base::Seed(5), nullptr).nodes;
  };
  const surrogate::TreeHyperparameters usual{.n_estimators = 5, .max_depth = 4};
  const auto expected = nodes(usual);
  auto h = usual;
  h.n_estimators = 6;
  EXPECT_NE(nodes(h), expected);
  h = usual, h.max_depth = 3;
  EXPECT_NE(nodes(h), expected);
  h = usual, h.learning_rate = 0.2;
  EXPECT_NE(nodes(h), expected);
  h = usual, h.colsample_bytree = 0.4;
  EXPECT_NE(nodes(h), expected);
  h = usual, h.reg_alpha = 5;
  EXPECT_NE(nodes(h), expected);
}

TEST(XgboostTrainer, RecordsWithoutWeightDoNotCount) {
  auto data = problem();
  const Eigen::Index half = data.train.targets.size() / 2;
  data.train.weights = Eigen::ArrayXd::Ones(data.train.targets.size());
  data.train.weights.tail(half) = 1e-9;
  data.train.targets.tail(half) = 1e4 + 5000 * data.train.inputs.col(2).tail(half);  // nonsense
  const auto grown = make_tree_trainer()->train(data, {.n_estimators = 60}, {}, base::Seed(1), nullptr);

  data.train.weights.setOnes();
  const auto misled = make_tree_trainer()->train(data, {.n_estimators = 60}, {}, base::Seed(1), nullptr);
  EXPECT_LT(grown.validation_mse, 0.2 * misled.validation_mse);
}

TEST(XgboostTrainer, TargetsThatDoNotVaryBecomeTheirMean) {
  auto data = problem();
  data.train.targets = 3;
  data.validation.targets = 3;
  const auto grown = make_tree_trainer()->train(data, {.n_estimators = 50}, {}, base::Seed(1), nullptr);

  Table predicted(data.validation.inputs.rows(), 1);
  particle::Trees(3, grown.nodes, {grown.group}).evaluate(data.validation.inputs, predicted);
  EXPECT_TRUE((predicted == 3).all());
}

TEST(XgboostTrainer, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  EXPECT_THROW((void)make_tree_trainer()->train(problem(), {}, {}, base::Seed(1), nullptr, stop.get_token()),
               Interrupted);
}

TEST(XgboostTrainer, NumbersThatAreNotFiniteAreRefused) {
  auto data = problem();
  data.train.targets[4] = NAN;
  EXPECT_THROW((void)make_tree_trainer()->train(data, {}, {}, base::Seed(1), nullptr), InputError);
  data = problem();
  data.validation.targets[4] = INFINITY;
  EXPECT_THROW((void)make_tree_trainer()->train(data, {}, {}, base::Seed(1), nullptr), InputError);
}

}  // namespace
}  // namespace elrom::xgboost
