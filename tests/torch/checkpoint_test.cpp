#include "checkpoint.hpp"

#include <gtest/gtest.h>

#include <set>

#include "support/changed_members.hpp"

namespace elrom::torch {
namespace {

TEST(Checkpoint, TheDigestOfATrainingKnowsAllThatItIsGiven) {
  const networks::TrainingProblem problem{.train_inputs = MatrixF::Zero(3, 2)};
  const networks::Hyperparameters usual;
  const networks::TrainingBudget budget;
  std::set<std::string> digests{training_digest(problem, usual, budget, base::Seed(1)),
                                training_digest(problem, usual, budget, base::Seed(2))};
  std::size_t n = 2;
  for (const auto& h : test::each_member_changed(usual)) {
    digests.insert(training_digest(problem, h, budget, base::Seed(1)));
    ++n;
  }
  for (const auto& other : test::each_member_changed(budget)) {
    digests.insert(training_digest(problem, usual, other, base::Seed(1)));
    ++n;
  }
  for (std::size_t i = 0; i < base::n_members<networks::TrainingProblem>(); ++i) {
    auto other = problem;
    std::size_t k = 0;
    base::for_each_member(other, [&](MatrixF& matrix) {
      if (k++ == i) matrix = MatrixF::Ones(3, 2);
    });
    digests.insert(training_digest(other, usual, budget, base::Seed(1)));
    ++n;
  }
  EXPECT_EQ(digests.size(), n);
}

}  // namespace
}  // namespace elrom::torch
