// What travels between ranks arrives as it was sent.

#include "units.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "support/changed_members.hpp"
#include "support/random_network.hpp"

namespace elrom::mpi {
namespace {

TEST(Units, ATrainingArrivesWithItsProblem) {
  networks::TrainingProblem problem;
  problem.train_inputs = MatrixF::Random(7, 3);
  problem.train_targets = MatrixF::Random(7, 2);
  problem.validation_inputs = MatrixF::Random(2, 3);
  problem.validation_targets = MatrixF::Random(2, 2);
  problem.train_weights = MatrixF::Ones(7, 2);
  const TrainUnit unit{
      .hyperparameters = {.learning_rate = 1.0 / 3, .n_layers = 3, .batch_size = 5, .dropout = 0.1},
      .budget = {11, 4},
      .seed = base::Seed(std::numeric_limits<std::uint64_t>::max() - 1),
      .monitored = true,
      .checkpoint = "/some/wh\xe9re"};  // Latin-1
  auto message = to_message(unit);
  EXPECT_FALSE(has_problem(message));
  add_data(message, problem);
  ASSERT_TRUE(has_problem(message));

  const auto arrived = train_unit_of(message);
  EXPECT_EQ(arrived.hyperparameters, unit.hyperparameters);
  EXPECT_EQ(arrived.budget.max_epochs, 11);
  EXPECT_EQ(arrived.budget.patience, 4);
  EXPECT_EQ(arrived.seed.value(), unit.seed.value());
  EXPECT_TRUE(arrived.monitored);
  EXPECT_EQ(arrived.checkpoint, "/some/wh\xe9re");
  const auto same = problem_of(message);
  EXPECT_EQ(digest_of(same), digest_of(problem));
  EXPECT_EQ(same.train_targets, problem.train_targets);
  EXPECT_EQ(same.validation_weights.size(), 0);
}

TEST(Units, EveryHyperparameterAndLimitArrives) {
  for (const auto& hyperparameters : test::each_member_changed(networks::Hyperparameters{})) {
    EXPECT_EQ(train_unit_of(to_message(TrainUnit{.hyperparameters = hyperparameters})).hyperparameters,
              hyperparameters);
  }
  for (const auto& budget : test::each_member_changed(networks::TrainingBudget{})) {
    EXPECT_EQ(base::digest_of_members(train_unit_of(to_message(TrainUnit{.budget = budget})).budget),
              base::digest_of_members(budget));
  }
}

TEST(Units, EveryScreeningSettingArrives) {
  networks::ScreeningData data;
  data.inputs = data.targets = MatrixF::Zero(1, 1);
  data.plane = data.case_of = {0};
  data.part = {networks::Part::train};
  for (const auto& settings : test::each_member_changed(networks::ScreenSettings{})) {
    auto sent = message(kind::crew);
    add_data(sent, data, settings, base::Seed(1));
    EXPECT_EQ(base::digest_of_members(screening_job_of(sent)->settings), base::digest_of_members(settings));
  }
}

TEST(Units, TheDigestTellsProblemsApart) {
  networks::TrainingProblem problem;
  problem.train_inputs = MatrixF::Ones(2, 3);
  auto other = problem;
  other.train_inputs = MatrixF::Ones(3, 2);
  EXPECT_NE(digest_of(other), digest_of(problem));
  other = {};
  other.validation_inputs = problem.train_inputs;
  EXPECT_NE(digest_of(other), digest_of(problem));
}

TEST(Units, ACrewGivesTheSameOutcomesFromDataThatTravelled) {
  networks::ScreeningData data;
  data.inputs = MatrixF::Random(40, 4);
  data.targets = MatrixF::Random(40, 18);
  data.n_planes = 4;
  for (int r = 0; r < 40; ++r) {
    data.plane.push_back(r % 4);
    data.case_of.push_back(r / 4);
    data.part.push_back(r < 24   ? networks::Part::train
                        : r < 32 ? networks::Part::validation
                                 : networks::Part::test);
  }
  networks::ScreenSettings settings;
  settings.max_epochs = 4;
  const base::Seed seed(3);
  auto message = to_message(CrewUnit{1, {0, 3, 17}});
  add_data(message, data, settings, seed);

  const auto there = screening_job_of(message);
  const auto unit = crew_unit_of(message);
  const auto outcomes = outcomes_of(to_message(networks::make_crew_trainer(
      there->data, there->settings, there->seed)(unit.i_build, unit.columns, {})));

  const auto here = networks::make_crew_trainer(data, settings, seed)(1, unit.columns, {});
  ASSERT_EQ(outcomes.size(), 3U);
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    EXPECT_EQ(outcomes[i].plane_error, here[i].plane_error);
    EXPECT_EQ(outcomes[i].error, here[i].error);
    EXPECT_EQ(outcomes[i].epochs, here[i].epochs);
  }
}

TEST(Units, AResultKeepsEveryFlagAndDigit) {
  networks::TrainingResult result;
  result.network = test::random_network({3, 5, 2}, model::Activation::relu, base::Seed(1));
  result.validation_mse = 0.1 + 0.2;
  result.epochs = 17;
  result.pruned = true;
  result.backed_off = true;
  const auto arrived = training_result_of(to_message(result));
  EXPECT_EQ(arrived.validation_mse, result.validation_mse);
  EXPECT_EQ(arrived.epochs, 17);
  EXPECT_TRUE(arrived.pruned);
  EXPECT_TRUE(arrived.backed_off);
  EXPECT_FALSE(arrived.diverged);
}

TEST(Units, AFailureComesBackAsTheTypeThatIsCaught) {
  EXPECT_THROW(rethrow(failure(ExitStatus::numerical, "x"), 2), NumericalError);
  EXPECT_THROW(rethrow(failure(ExitStatus::interrupted, "x"), 2), Interrupted);
  try {
    rethrow(failure(ExitStatus::not_built, "no CUDA"), 2);
  } catch (const Error& error) {
    EXPECT_EQ(error.status(), ExitStatus::not_built);
    EXPECT_STREQ(error.what(), "rank 2: no CUDA");
  }
}

}  // namespace
}  // namespace elrom::mpi
