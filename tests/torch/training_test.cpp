// The hand-written gradient and Adam step against LibTorch's autograd and optimisers.

#include "training.hpp"

#include <gtest/gtest.h>
#include <torch/optim/adamw.h>

#include "support/random_network.hpp"

namespace elrom::torch {
namespace {

using test::random_matrix;
using ::torch::Tensor;

networks::TrainingProblem noisy_problem(bool weighted) {
  networks::TrainingProblem problem;
  problem.train_inputs = random_matrix(40, 6, base::Seed(1));
  problem.train_targets = random_matrix(40, 5, base::Seed(2));
  problem.validation_inputs = random_matrix(10, 6, base::Seed(3));
  problem.validation_targets = random_matrix(10, 5, base::Seed(4));
  if (!weighted) return problem;
  problem.train_weights = (random_matrix(40, 5, base::Seed(5)).array() > 0).cast<float>();
  problem.validation_weights = (random_matrix(10, 5, base::Seed(6)).array() > 0).cast<float>();
  return problem;
}

Tensor to_torch(const MatrixF& matrix) {
  return ::torch::from_blob(const_cast<float*>(matrix.data()), {matrix.rows(), matrix.cols()}).clone();
}

// Loss of the flat parameters as LibTorch's own operators give it.
Tensor autograd_loss(const Tensor& flat, const std::vector<std::int64_t>& widths,
                     model::Activation activation, const networks::TrainingProblem& problem) {
  Tensor x = to_torch(problem.train_inputs);
  std::int64_t at = 0;
  for (std::size_t i = 1; i < widths.size(); ++i) {
    const auto n = widths[i] * widths[i - 1];
    x = ::torch::linear(x, flat.slice(0, at, at + n).view({widths[i], widths[i - 1]}),
                        flat.slice(0, at + n, at + n + widths[i]));
    at += n + widths[i];
    if (i + 1 == widths.size()) break;
    x = activation == model::Activation::relu   ? ::torch::relu(x)
        : activation == model::Activation::tanh ? ::torch::tanh(x)
                                                : ::torch::silu(x);
  }
  const Tensor squares = (x - to_torch(problem.train_targets)).square();
  if (problem.train_weights.size() == 0) return squares.mean();
  const Tensor weights = to_torch(problem.train_weights);
  return (squares * weights).sum() / weights.sum();
}

struct Case {
  model::Activation activation;
  bool weighted;
  bool own_loops = true;
};
class Step : public ::testing::TestWithParam<Case> {};

TEST_P(Step, EqualsAutogradAndLibTorchsAdamW) {
  const auto problem = noisy_problem(GetParam().weighted);
  const networks::Hyperparameters hyperparameters{.learning_rate = 1e-2,
                                                  .n_layers = 2,
                                                  .n_units = 7,
                                                  .batch_size = 40,
                                                  .weight_decay = 0.1,
                                                  .activation = GetParam().activation};
  Training training(problem, hyperparameters, base::Seed(9), {.own_loops = GetParam().own_loops});
  Tensor parameters = training.mlp().parameters().clone().set_requires_grad(true);
  ::torch::optim::AdamW adam({parameters}, ::torch::optim::AdamWOptions(1e-2).weight_decay(0.1));
  std::vector<std::int64_t> rows(40);
  std::iota(rows.begin(), rows.end(), 0);

  for (int i = 0; i < 5; ++i) {
    adam.zero_grad();
    autograd_loss(parameters, training.mlp().widths(), GetParam().activation, problem).backward();
    training.step(rows);
    const Tensor gradient = training.mlp().gradient();
    EXPECT_LT((gradient - parameters.grad()).norm().item<double>(),
              1e-5 * parameters.grad().norm().item<double>());
    adam.step();
  }

  const Tensor difference = training.mlp().parameters() - parameters.detach();
  EXPECT_LT(difference.norm().item<double>(), 1e-5 * parameters.norm().item<double>());
}

INSTANTIATE_TEST_SUITE_P(Kinds, Step,
                         ::testing::Values(Case{model::Activation::relu, false},
                                           Case{model::Activation::relu, true},
                                           Case{model::Activation::tanh, false},
                                           Case{model::Activation::silu, true},
                                           Case{model::Activation::relu, false, false},
                                           Case{model::Activation::silu, true, false}));

// What a GPU runs, on the CPU: the same training to rounding, whatever it draws, weighs and stops by.
TEST(Training, LibTorchsOperatorsDoWhatOurLoopsDo) {
  const auto problem = noisy_problem(true);
  const networks::Hyperparameters hyperparameters{
      .n_units = 9, .batch_size = 16, .weight_decay = 0.1, .dropout = 0.2};
  Training loops(problem, hyperparameters, base::Seed(9), {});
  Training operators(problem, hyperparameters, base::Seed(9), {.own_loops = false});

  for (int epoch = 0; epoch < 5; ++epoch) {
    ASSERT_TRUE(loops.run_epoch());
    ASSERT_TRUE(operators.run_epoch());
  }

  const auto& expected = loops.progress().history;
  ASSERT_EQ(operators.progress().history.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(operators.progress().history[i], expected[i], 1e-5 * expected[i]);
  const Tensor difference = operators.best() - loops.best();
  EXPECT_LT(difference.norm().item<double>(), 1e-5 * loops.best().norm().item<double>());
}

TEST(Training, DropoutKeepsTheExpectedValue) {
  Mlp mlp({4, 1000, 2}, model::Activation::relu, ::torch::kCPU);
  Pass pass = mlp.make_pass(20, false, true, true);
  base::Random random(base::Seed(1));

  Mlp::draw_dropout(pass, 0.25, random);

  EXPECT_NEAR(pass.kept[0].mean().item<double>(), 1, 0.02);  // 20,000 draws: standard error 0.004
  EXPECT_NEAR((pass.kept[0] == 0).to(::torch::kFloat32).mean().item<double>(), 0.25, 0.02);
}

TEST(Training, EvaluationIsTheMeanOverTargetsThatCount) {
  const auto problem = noisy_problem(true);
  Training training(problem, {.n_layers = 0}, base::Seed(9), {});

  const double mse = training.evaluate();

  const Tensor flat = training.mlp().parameters();
  auto swapped = problem;
  swapped.train_inputs = problem.validation_inputs;
  swapped.train_targets = problem.validation_targets;
  swapped.train_weights = problem.validation_weights;
  const double expected = autograd_loss(flat, {6, 5}, model::Activation::relu, swapped).item<double>();
  EXPECT_NEAR(mse, expected, 1e-6 * expected);
}

TEST(Training, ARateFactorCountsForEveryStepOfItsEpoch) {
  const auto problem = noisy_problem(false);
  const networks::Hyperparameters whole{.learning_rate = 4e-3, .n_units = 8, .batch_size = 16},
      half{.learning_rate = 2e-3, .n_units = 8, .batch_size = 16};
  Training factored(problem, whole, base::Seed(9), {}), halved(problem, half, base::Seed(9), {});

  ASSERT_TRUE(factored.run_epoch(0, 0.5) && halved.run_epoch());

  EXPECT_TRUE(::torch::equal(factored.mlp().parameters(), halved.mlp().parameters()));
  ASSERT_TRUE(factored.run_epoch(0, 0));
  EXPECT_TRUE(::torch::equal(factored.mlp().parameters(), halved.mlp().parameters()));
  ASSERT_TRUE(factored.run_epoch());
  EXPECT_FALSE(::torch::equal(factored.mlp().parameters(), halved.mlp().parameters()));
}

TEST(Training, AnEpochStepsThroughNoMoreRecordsThanItMay) {
  const auto problem = noisy_problem(false);  // 40 records
  const networks::Hyperparameters hyperparameters{.n_layers = 1, .n_units = 4, .batch_size = 5};
  Training some(problem, hyperparameters, base::Seed(9), {}),
      all(problem, hyperparameters, base::Seed(9), {});

  ASSERT_TRUE(some.run_epoch(15));
  EXPECT_EQ(some.adam().n_steps(), 3) << "13 records, the last batch short";
  ASSERT_TRUE(some.run_epoch(15) && some.run_epoch(15) && all.run_epoch());

  EXPECT_EQ(some.progress().epoch, 3);
  EXPECT_EQ(some.progress().history.size(), 3U);
  EXPECT_EQ(all.adam().n_steps(), 8);
}

}  // namespace
}  // namespace elrom::torch
