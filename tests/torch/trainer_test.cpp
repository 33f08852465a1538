#include "elrom/torch/trainer.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "support/random_network.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::torch {
namespace {

using networks::Hyperparameters;
using networks::TrainingProblem;
using networks::TrainingResult;

// Two smooth outputs of three inputs.
networks::TrainingProblem smooth_problem(Eigen::Index n_train = 200, float noise = 0) {
  networks::TrainingProblem problem;
  const auto targets = [&](const MatrixF& x, std::uint64_t seed) {
    MatrixF y(x.rows(), 2);
    y.col(0) = (x.col(0).array() + 0.5F * x.col(1).array()).sin();
    y.col(1) = x.col(2).array() * x.col(0).array().cos();
    return MatrixF(y + noise * test::random_matrix(x.rows(), 2, base::Seed(seed)));
  };
  problem.train_inputs = test::random_matrix(n_train, 3, base::Seed(1));
  problem.validation_inputs = test::random_matrix(60, 3, base::Seed(2));
  problem.train_targets = targets(problem.train_inputs, 3);
  problem.validation_targets = targets(problem.validation_inputs, 4);
  return problem;
}

double mse_of(const model::Network& network, const MatrixF& inputs, const MatrixF& targets) {
  MatrixF y(inputs.rows(), targets.cols());
  model::Workspace workspace;
  network.forward(inputs, y, workspace);
  return (y - targets).cast<double>().array().square().mean();
}

std::vector<float> weights_of(const model::Network& network) {
  std::vector<float> all;
  for (const auto& layer : network.layers()) {
    all.insert(all.end(), layer.weights.f32().begin(), layer.weights.f32().end());
    all.insert(all.end(), layer.bias.f32().begin(), layer.bias.f32().end());
  }
  return all;
}

class Recorder : public networks::TrainingMonitor {
 public:
  explicit Recorder(std::function<bool(int)> go_on = [](int) { return true; }) : go_on_(std::move(go_on)) {}
  bool keep_going(int epoch, double validation_mse) override {
    errors.push_back(validation_mse);
    return go_on_(epoch);
  }
  std::vector<double> errors;

 private:
  std::function<bool(int)> go_on_;
};

const networks::Hyperparameters usual{.learning_rate = 5e-3, .n_layers = 2, .n_units = 32, .batch_size = 32};

TEST(TorchTrainer, LearnsASmoothFunction) {
  const auto problem = smooth_problem();

  const auto result = make_torch_trainer()->train(problem, usual, {150, 30}, base::Seed(1), nullptr, {});

  EXPECT_LT(result.validation_mse, 0.05);
  EXPECT_LT(result.train_mse, 0.02);
  EXPECT_FALSE(result.diverged);
}

TEST(TorchTrainer, DropoutCostsSomeOfTheFitButNotAllOfIt) {
  const auto problem = smooth_problem();
  auto dropping = usual;
  dropping.dropout = 0.3;

  const auto with = make_torch_trainer()->train(problem, dropping, {60, 60}, base::Seed(1), nullptr, {}),
             without = make_torch_trainer()->train(problem, usual, {60, 60}, base::Seed(1), nullptr, {});

  EXPECT_GT(with.train_mse, 1.5 * without.train_mse);
  EXPECT_LT(with.train_mse, 0.2 * problem.train_targets.array().square().mean());
}

TEST(TorchTrainer, GoesOnFromTheWeightsItIsGiven) {
  auto problem = smooth_problem();
  const auto trainer = make_torch_trainer();
  const auto first = trainer->train(problem, usual, {150, 30}, base::Seed(1), nullptr, {});
  problem.start = networks::parameters_of(first.network);
  auto slow = usual;
  slow.learning_rate = 1e-9;

  const auto same = trainer->train(problem, slow, {1, 1}, base::Seed(2), nullptr, {});
  const auto on = trainer->train(problem, usual, {150, 5}, base::Seed(2), nullptr, {});

  EXPECT_NEAR(same.validation_mse, first.validation_mse, 1e-4 * first.validation_mse);
  EXPECT_LT(on.epochs, first.epochs / 2);
  EXPECT_LT(on.validation_mse, 1.5 * first.validation_mse);
  EXPECT_NE(weights_of(on.network), weights_of(first.network)) << "an epoch at least";
}

TEST(TorchTrainer, EarlyStoppingRestoresTheBestWeights) {
  const auto problem = smooth_problem(20, 0.5F);  // few noisy records: it overfits soon
  Recorder recorder;

  const auto result = make_torch_trainer()->train(problem, usual, {400, 15}, base::Seed(1), &recorder, {});

  const auto best = std::min_element(recorder.errors.begin(), recorder.errors.end());
  EXPECT_LT(result.epochs, 400);
  EXPECT_EQ(recorder.errors.end() - best - 1, 15) << "as many epochs after the best as the patience";
  EXPECT_EQ(result.validation_mse, *best);
  EXPECT_NEAR(mse_of(result.network, problem.validation_inputs, problem.validation_targets), *best,
              1e-5 * *best);
}

TEST(TorchTrainer, AnnealedItEndsByEverSmallerSteps) {
  const auto problem = smooth_problem(200, 0.3F);
  const auto trainer = make_torch_trainer();
  const auto jitter_at_the_end = [&](bool anneal) {
    Recorder recorder;
    (void)trainer->train(problem, usual, {.max_epochs = 40, .patience = 40, .anneal = anneal}, base::Seed(1),
                         &recorder, {});
    const auto& errors = recorder.errors;
    return std::abs(errors[39] - errors[38]) + std::abs(errors[38] - errors[37]);
  };

  EXPECT_LT(jitter_at_the_end(true), 0.1 * jitter_at_the_end(false));
}

TEST(TorchTrainer, TheSameSeedGivesTheSameBitsOnAnyThread) {
  const auto problem = smooth_problem();
  const auto trainer = make_torch_trainer();
  networks::Hyperparameters hyperparameters = usual;
  hyperparameters.dropout = 0.1;
  std::vector<networks::TrainingResult> results(6);

  base::parallel_for(6, 3, [&](std::size_t i, int) {
    results[i] = trainer->train(problem, hyperparameters, {12, 12}, base::Seed(i / 2), nullptr, {});
  });

  for (const std::size_t i : {0, 2, 4})
    EXPECT_EQ(weights_of(results[i].network), weights_of(results[i + 1].network));
  EXPECT_NE(weights_of(results[0].network), weights_of(results[2].network));
}

TEST(TorchTrainer, MaskedTargetsDoNotCount) {
  auto problem = smooth_problem();
  problem.train_weights = MatrixF::Ones(200, 2);
  problem.validation_weights = MatrixF::Ones(60, 2);
  problem.train_weights.col(1).setZero();
  problem.validation_weights.col(1).setZero();
  auto spoilt = problem;
  spoilt.train_targets.col(1).setConstant(1e3F);
  spoilt.validation_targets.col(1).setConstant(-1e3F);

  const auto trainer = make_torch_trainer();
  const auto plain = trainer->train(problem, usual, {20, 20}, base::Seed(1), nullptr, {});
  const auto with_spoilt = trainer->train(spoilt, usual, {20, 20}, base::Seed(1), nullptr, {});

  EXPECT_EQ(plain.validation_mse, with_spoilt.validation_mse);
  EXPECT_EQ(weights_of(plain.network), weights_of(with_spoilt.network));
}

TEST(TorchTrainer, PrunedByItsMonitor) {
  Recorder recorder([](int epoch) { return epoch < 4; });

  const auto result =
      make_torch_trainer()->train(smooth_problem(), usual, {50, 50}, base::Seed(1), &recorder, {});

  EXPECT_TRUE(result.pruned);
  EXPECT_EQ(result.epochs, 4);
}

TEST(TorchTrainer, ResumedFromACheckpointItEndsWithTheSameBits) {
  const auto problem = smooth_problem();
  networks::Hyperparameters hyperparameters = usual;
  hyperparameters.dropout = 0.2;
  const networks::TrainingBudget annealed{.max_epochs = 25, .patience = 25, .anneal = true};
  const test::TemporaryFolder folder;
  const auto checkpoint = folder / "build.checkpoint";
  const auto trainer = make_torch_trainer();
  Recorder straight_errors, resumed_errors;
  const auto straight =
      trainer->train(problem, hyperparameters, annealed, base::Seed(1), &straight_errors, {});
  std::stop_source source;
  Recorder stopper([&](int epoch) {
    if (epoch == 9) source.request_stop();
    return true;
  });

  EXPECT_THROW((void)trainer->train(problem, hyperparameters, annealed, base::Seed(1), &stopper,
                                    source.get_token(), checkpoint),
               Interrupted);
  ASSERT_TRUE(std::filesystem::exists(checkpoint));
  const auto resumed =
      trainer->train(problem, hyperparameters, annealed, base::Seed(1), &resumed_errors, {}, checkpoint);

  EXPECT_EQ(weights_of(straight.network), weights_of(resumed.network));
  EXPECT_EQ(straight_errors.errors, resumed_errors.errors) << "the monitor hears of the first epochs again";
  EXPECT_FALSE(std::filesystem::exists(checkpoint));
}

TEST(TorchTrainer, ACheckpointOfAnotherTrainingOrADamagedOneIsNotUsed) {
  const auto problem = smooth_problem();
  const test::TemporaryFolder folder;
  const auto trainer = make_torch_trainer();
  const auto expected =
      weights_of(trainer->train(problem, usual, {8, 8}, base::Seed(2), nullptr, {}).network);
  std::stop_source source;
  Recorder stopper([&](int epoch) {
    if (epoch == 3) source.request_stop();
    return true;
  });
  const auto checkpoint = folder / "build.checkpoint";
  EXPECT_THROW(
      (void)trainer->train(problem, usual, {8, 8}, base::Seed(1), &stopper, source.get_token(), checkpoint),
      Interrupted);
  auto bytes = test::read_bytes(checkpoint);

  const auto of_another = trainer->train(problem, usual, {8, 8}, base::Seed(2), nullptr, {}, checkpoint);
  bytes[bytes.size() - 5] ^= 4;
  test::write_bytes(checkpoint, bytes);
  const auto first = trainer->train(problem, usual, {8, 8}, base::Seed(1), nullptr, {});
  const auto damaged = trainer->train(problem, usual, {8, 8}, base::Seed(1), nullptr, {}, checkpoint);

  EXPECT_EQ(weights_of(of_another.network), expected);
  EXPECT_EQ(weights_of(damaged.network), weights_of(first.network));
}

TEST(TorchTrainer, ACheckpointOfANewerMajorVersionIsNotUsed) {
  const auto problem = smooth_problem();
  const test::TemporaryFolder folder;
  const auto trainer = make_torch_trainer();
  const auto checkpoint = folder / "build.checkpoint";
  // Epochs that a training runs with such a checkpoint of six.
  const auto epochs_left = [&](const std::string& format) {
    std::stop_source source;
    Recorder stopper([&](int epoch) {
      if (epoch == 6) source.request_stop();
      return true;
    });
    EXPECT_THROW(
        (void)trainer->train(problem, usual, {8, 8}, base::Seed(1), &stopper, source.get_token(), checkpoint),
        Interrupted);
    io::TensorFile marked;
    {
      const auto file = io::TensorFile::open(checkpoint);
      for (const auto& [name, tensor] : file.tensors()) marked.set(name, tensor);
      for (const auto& [key, text] : file.texts()) marked.set_text(key, text);
      marked.set_text("format", format);
      marked.write(checkpoint);
    }
    std::stop_source at_once;
    at_once.request_stop();
    Recorder heard;
    EXPECT_THROW(
        (void)trainer->train(problem, usual, {8, 8}, base::Seed(1), &heard, at_once.get_token(), checkpoint),
        Interrupted);
    std::filesystem::remove(checkpoint);
    return 8 - heard.errors.size();
  };

  EXPECT_EQ(epochs_left("1.3"), 2u);
  EXPECT_EQ(epochs_left("2.0"), 8u);
}

TEST(TorchTrainer, ADivergingRateIsBackedOffOnceAndThenLost) {
  networks::Hyperparameters wild = usual;
  wild.learning_rate = 1e30;

  const auto result =
      make_torch_trainer()->train(smooth_problem(), wild, {50, 20}, base::Seed(1), nullptr, {});

  EXPECT_TRUE(result.backed_off);
  EXPECT_TRUE(result.diverged);
  EXPECT_TRUE(std::isfinite(result.validation_mse));
  EXPECT_TRUE(result.network.layers().empty());
}

TEST(TorchTrainer, WildDataNeverWinWithNotANumber) {
  for (const float wild : {1e30F, std::nanf("")}) {
    auto problem = smooth_problem();
    problem.train_targets(7, 1) = wild;

    const auto result = make_torch_trainer()->train(problem, usual, {20, 10}, base::Seed(1), nullptr, {});

    EXPECT_TRUE(std::isfinite(result.validation_mse));
    if (!result.diverged) {
      EXPECT_THAT(weights_of(result.network),
                  ::testing::Each(::testing::Truly([](float w) { return std::isfinite(w); })));
    }
  }
}

TEST(TorchTrainer, TinyBatchesAndSingleRecordsWork) {
  auto problem = smooth_problem(1);
  networks::Hyperparameters tiny = usual;
  tiny.batch_size = 1;

  const auto result = make_torch_trainer()->train(problem, tiny, {3, 3}, base::Seed(1), nullptr, {});

  EXPECT_TRUE(std::isfinite(result.validation_mse));
}

TEST(TorchTrainer, UnknownDevicesAreRefused) {
  EXPECT_THROW((void)make_torch_trainer("gpu"), UsageError);
  EXPECT_THROW((void)make_torch_trainer("cuda:x"), Error);
}

}  // namespace
}  // namespace elrom::torch
