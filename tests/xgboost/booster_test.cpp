// Flat trees against the library that grew them.

#include "booster.hpp"

#include <gtest/gtest.h>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "support/throws.hpp"

namespace elrom::xgboost {
namespace {

using particle::Table;

Table random_table(Eigen::Index rows, Eigen::Index columns, std::uint64_t seed) {
  base::Random random{base::Seed(seed)};
  Table table(rows, columns);
  for (auto& x : table.reshaped()) x = random.normal();
  return table;
}

Eigen::ArrayXd bumps(const Table& x) {
  return (3 * x.col(0)).sin() + x.col(1) * x.col(2) + 0.5 * x.col(3).square();
}

TEST(Booster, FlatTreesGiveWhatXgboostPredicts) {
  for (const auto& [depth, columns] : {std::pair{"2", "1"}, {"9", "0.5"}}) {
    const Table inputs = random_table(3000, 4, 1), others = random_table(20000, 4, 2);
    Matrix train(inputs), unseen(others);
    train.set("label", bumps(inputs));
    Booster booster(train, unseen,
                    {{"tree_method", "hist"},
                     {"objective", "reg:squarederror"},
                     {"base_score", "0.25"},
                     {"nthread", "1"},
                     {"verbosity", "0"},
                     {"alpha", "2"},
                     {"colsample_bytree", columns},
                     {"max_depth", depth}});
    for (int round = 0; round < 40; ++round) booster.grow(round);

    auto flat = booster.trees(40);
    const particle::Trees trees(4, flat.nodes, {flat.group});
    Table ours(others.rows(), 1);
    trees.evaluate(others, ours);

    const auto theirs = booster.predict(unseen);
    EXPECT_EQ(trees.n_trees(), 40U);
    EXPECT_EQ(flat.group.base, 0.25);
    ASSERT_EQ(theirs.size(), 20000U);
    double greatest = 0;
    for (std::size_t i = 0; i < theirs.size(); ++i)
      greatest = std::max(greatest,
                          std::abs(ours(static_cast<Eigen::Index>(i), 0) - static_cast<double>(theirs[i])));
    EXPECT_LT(greatest, 1e-5) << "40 sums in float";
    EXPECT_GT((bumps(others) - bumps(others).mean()).square().mean(),
              1.5 * (ours.col(0) - bumps(others)).square().mean())
        << "it learned something";
  }
}

TEST(Booster, ValuesOnAThresholdGoTheSameWay) {
  Table inputs(8, 1);
  inputs << 0, 1, 2, 3, 4, 5, 6, 7;
  Matrix train(inputs);
  train.set("label", inputs.col(0).square());
  Booster booster(train, train,
                  {{"tree_method", "hist"}, {"nthread", "1"}, {"verbosity", "0"}, {"min_child_weight", "0"}});
  for (int round = 0; round < 5; ++round) booster.grow(round);
  const auto flat = booster.trees(5);
  // Cuts lie on the records or between them; every threshold itself is asked.
  Table asked(static_cast<Eigen::Index>(flat.nodes.size()), 1);
  for (std::size_t i = 0; i < flat.nodes.size(); ++i)
    asked(static_cast<Eigen::Index>(i), 0) = flat.nodes[i].value;
  Table ours(asked.rows(), 1);
  particle::Trees(1, flat.nodes, {flat.group}).evaluate(asked, ours);

  const Matrix matrix(asked);
  const auto theirs = booster.predict(matrix);

  for (Eigen::Index i = 0; i < asked.rows(); ++i)
    EXPECT_NEAR(ours(i, 0), theirs[static_cast<std::size_t>(i)], 1e-5) << asked(i, 0);
}

TEST(Booster, RecordsThatAreNotFiniteAreRefused) {
  Table inputs = random_table(10, 2, 1);
  inputs(3, 1) = 1e300;  // infinite as a float
  EXPECT_ERROR(InputError, "not finite", Matrix(inputs));
  EXPECT_ERROR(InputError, "no records", Matrix(Table(0, 2)));
  Matrix matrix(random_table(10, 2, 1));
  EXPECT_THROW(matrix.set("label", Eigen::ArrayXd::Constant(10, NAN)), InputError);
}

TEST(Booster, WhatXgboostRefusesIsSaidInItsWords) {
  const Table inputs = random_table(10, 2, 1);
  Matrix train(inputs);
  train.set("label", inputs.col(0));
  Booster booster(train, train, {{"objective", "reg:nonsense"}, {"verbosity", "0"}});

  EXPECT_ERROR(SystemError, "reg:nonsense", booster.grow(0));
}

}  // namespace
}  // namespace elrom::xgboost
