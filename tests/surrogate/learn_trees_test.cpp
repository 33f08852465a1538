#include "elrom/surrogate/learn_trees.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <mutex>
#include <set>

#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::surrogate {
namespace {

using particle::Table;

// Stands for a library: one tree that splits input 0 at its mean; the "error" falls with the rounds towards a
// bowl over the hyperparameters with its least value at rate 0.1 and depth 6.
class FakeTrainer final : public TreeTrainer {
 public:
  [[nodiscard]] std::string name() const override { return "fake"; }
  [[nodiscard]] GrownTrees train(const TreeProblem& problem, const TreeHyperparameters& h,
                                 const TreeBudget& budget, base::Seed, networks::TrainingMonitor* monitor,
                                 const std::stop_token&) const override {
    {
      const std::scoped_lock lock(mutex);
      problems.push_back(problem);
      asked.push_back(h);
    }
    if (++calls == kill_at) throw Interrupted("killed");
    GrownTrees grown;
    const double goal =
        0.1 + std::pow(std::log10(h.learning_rate / 0.1), 2) + 0.02 * std::abs(h.max_depth - 6);
    for (int round = 1; round <= h.n_estimators; ++round) {
      grown.rounds = round;
      grown.validation_mse = goal + std::exp(-round / 20.0);
      if (monitor != nullptr && !monitor->keep_going(round, grown.validation_mse)) {
        grown.pruned = true;
        return grown;
      }
    }
    if (!budget.keep_trees) return grown;
    const auto& x = problem.train.inputs;
    const double mean = x.col(0).mean();
    const auto above = (x.col(0) >= mean).cast<double>();
    const double high = (problem.train.targets * above).sum() / above.sum(),
                 low = (problem.train.targets * (1 - above)).sum() / (1 - above).sum();
    grown.nodes = {{0, 1, static_cast<float>(mean)},
                   {-1, 0, static_cast<float>(low)},
                   {-1, 0, static_cast<float>(high)}};
    grown.group = {0, {0}};
    return grown;
  }
  mutable std::mutex mutex;
  mutable std::vector<TreeProblem> problems;
  mutable std::vector<TreeHyperparameters> asked;
  mutable std::atomic<int> calls = 0;
  int kill_at = -1;
};

// Two outputs, steps of input 0 at zero; input 1 numbers the records.
struct Steps {
  explicit Steps(Eigen::Index n = 400) : inputs(n, 2), targets(n, 2), weights(n) {
    base::Random random{base::Seed(4)};
    for (Eigen::Index i = 0; i < n; ++i) {
      inputs(i, 0) = (i % 2 == 0 ? 1 : -1) * random.uniform(1, 2);
      inputs(i, 1) = static_cast<double>(i);
      targets(i, 0) = i % 2 == 0 ? 5 : -5;
      targets(i, 1) = 10 * targets(i, 0);
      weights[i] = 1 + static_cast<double>(i);
    }
  }
  Table inputs, targets;
  Eigen::ArrayXd weights;
};

TEST(LearnTrees, EachOutputGetsItsOwnTrees) {
  const Steps data;
  const FakeTrainer trainer;

  const auto learned = learn_trees(data.inputs, data.targets, {}, {.trials = 0}, trainer, {});

  Table predicted(400, 2);
  learned.trees->evaluate(data.inputs, predicted);
  EXPECT_TRUE((predicted == data.targets).all());
  EXPECT_EQ(trainer.calls, 2) << "no search";
  EXPECT_EQ(learned.rounds, (std::vector{1, 1}));
}

TEST(LearnTrees, AQuarterValidatesAndEveryRecordServesOnceWithItsOwnTargetAndWeight) {
  const Steps data;
  const FakeTrainer trainer;

  (void)learn_trees(data.inputs, data.targets, data.weights, {.trials = 0}, trainer, {});

  for (const auto& problem : trainer.problems) {
    EXPECT_EQ(problem.validation.targets.size(), 100);
    std::set<int> seen;
    for (const auto* part : {&problem.train, &problem.validation})
      for (Eigen::Index i = 0; i < part->targets.size(); ++i) {
        const auto record = static_cast<int>(part->inputs(i, 1));
        seen.insert(record);
        EXPECT_EQ(part->weights[i], 1.0 + record);
        EXPECT_EQ(std::signbit(part->targets[i]), record % 2 == 1);
      }
    EXPECT_EQ(seen.size(), 400U);
  }
  EXPECT_TRUE((trainer.problems[0].train.inputs == trainer.problems[1].train.inputs).all())
      << "all outputs are validated on the same records";
}

TEST(LearnTrees, TheSearchWorksOnASampleOfOneOutputAndServesAll) {
  const Steps data;
  const FakeTrainer trainer;
  const TreeSettings settings{.trials = 30, .searched_output = 1, .search_records = 80};

  const auto learned = learn_trees(data.inputs, data.targets, {}, settings, trainer, {});

  EXPECT_EQ(trainer.calls, 30 + 2);
  EXPECT_EQ(trainer.problems[0].train.targets.size(), 60);
  EXPECT_EQ(trainer.problems[0].validation.targets.size(), 20);
  EXPECT_EQ(trainer.problems[0].train.targets.abs().minCoeff(), 50) << "output 1";
  EXPECT_NEAR(std::log10(learned.hyperparameters.learning_rate), -1, 0.15);
  EXPECT_NEAR(learned.hyperparameters.max_depth, 6, 1);
  EXPECT_EQ(trainer.asked.back().max_depth, learned.hyperparameters.max_depth);
  EXPECT_EQ(trainer.asked.back().n_estimators, 2 * learned.hyperparameters.n_estimators);
}

TEST(LearnTrees, AKilledSearchResumesToTheSameTrees) {
  const test::TemporaryFolder folder;
  const Steps data;
  const TreeSettings settings{.trials = 20};
  FakeTrainer whole, killed, resumed;
  const auto expected = learn_trees(data.inputs, data.targets, {}, settings, whole, {});
  killed.kill_at = 12;
  {
    TreeStore store(folder / "search.sqlite");
    EXPECT_THROW((void)learn_trees(data.inputs, data.targets, {}, settings, killed, {.store = &store}),
                 Interrupted);
  }
  TreeStore store(folder / "search.sqlite");

  const auto learned = learn_trees(data.inputs, data.targets, {}, settings, resumed, {.store = &store});

  EXPECT_EQ(learned.n_replayed, 11U);
  EXPECT_EQ(resumed.calls, whole.calls - 11);
  EXPECT_EQ(learned.hyperparameters, expected.hyperparameters);
  EXPECT_EQ(learned.trees->nodes(), expected.trees->nodes());
  const auto other = learn_trees(data.inputs, 2 * data.targets, {}, settings, resumed, {.store = &store});
  EXPECT_EQ(other.n_replayed, 0U) << "trials of other records do not count";
}

TEST(LearnTrees, TooFewRecordsAreRefused) {
  const Steps data(9);
  EXPECT_ERROR(InputError, "too few records",
               learn_trees(data.inputs, data.targets, {}, {}, FakeTrainer(), {}));
}

TEST(LearnTrees, ABuildWithoutATrainerSaysSo) {
  const Steps data;
  EXPECT_ERROR(NotBuiltError, "-DELROM_XGBOOST=ON",
               learn_trees(data.inputs, data.targets, {}, {}, *missing_tree_trainer(), {}));
}

particle::CollisionSet collisions(std::size_t n, double greatest) {
  particle::CollisionSet set;
  set.protocol.kind = particle::ProtocolKind::document;
  set.protocol.speed = {0, greatest};
  set.pairs = particle::Pairs(n);
  set.parting.after = particle::Motion(n);
  base::Random random{base::Seed(n)};
  for (auto* table : {&set.pairs.before.velocity_1, &set.pairs.before.velocity_2})
    for (auto& v : table->reshaped()) v = random.uniform(-greatest, greatest) / 2;
  // What the fake can learn to about half the size: all components follow u of sphere 1.
  for (Eigen::Index k = 0; k < 3; ++k) {
    set.parting.after.velocity_1.col(k) =
        static_cast<double>(k + 1) * set.pairs.before.velocity_1.col(0).sign();
    set.parting.after.velocity_2.col(k) =
        -static_cast<double>(k + 1) * set.pairs.before.velocity_1.col(0).sign();
  }
  return set;
}

TEST(LearnDocument, FivePercentJudgeAndAQuarterOfTheRestValidates) {
  const auto set = collisions(2000, 20);
  const FakeTrainer trainer;

  const auto learned = learn_document(set, nullptr, {.trees = {.trials = 0}}, trainer, {});

  EXPECT_EQ(learned.full.test.size(), 100U);
  ASSERT_EQ(trainer.problems.size(), 6U);
  EXPECT_EQ(trainer.problems[0].validation.targets.size(), 475);
  EXPECT_EQ(trainer.problems[0].train.targets.size(), 1425);
  // Standardised on everything but the test pairs.
  Table known(1900, 6);
  known << trainer.problems[0].train.inputs, trainer.problems[0].validation.inputs;
  for (Eigen::Index k = 0; k < 6; ++k) {
    EXPECT_NEAR(known.col(k).mean(), 0, 1e-12);
    EXPECT_NEAR(known.col(k).square().mean(), 1, 1e-3);
  }
}

TEST(LearnDocument, ItsErrorsAreThoseOfItsModelOnTheTestPairs) {
  const auto set = collisions(2000, 20);
  const FakeTrainer trainer;

  const auto learned = learn_document(set, nullptr, {.trees = {.trials = 0}}, trainer, {});

  const Table before = particle::six_velocities(set.pairs.before),
              after = particle::six_velocities(set.parting.after);
  const Table error = (learned.model->velocities_after(before) - after).abs();
  for (std::size_t k = 0; k < 6; ++k) {
    double sum = 0;
    for (const auto i : learned.full.test)
      sum += error(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
    EXPECT_NEAR(learned.full.mae[k], sum / 100, 1e-12);
  }
}

TEST(LearnDocument, SlowPairsGetTreesOfTheirOwn) {
  const auto full = collisions(1000, 20);
  auto low = collisions(800, 2);
  low.parting.after.velocity_1 *= 100;
  const FakeTrainer trainer;

  const auto learned = learn_document(full, &low, {.trees = {.trials = 0}}, trainer, {.n_threads = 2});

  ASSERT_TRUE(learned.low.has_value());
  EXPECT_EQ(learned.low->test.size(), 40U);
  Table asked(2, 6);
  asked << 1.5, 0, 0, 0, 0, 1.9,  // slow
      1.5, 0, 0, 0, 0, 2.1;       // not
  const Table after = learned.model->velocities_after(asked);
  EXPECT_EQ(after(0, 0), 100);
  EXPECT_NEAR(after(1, 0), 1, 0.2);
}

}  // namespace
}  // namespace elrom::surrogate
