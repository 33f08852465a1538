#include "elrom/particle/trees.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::particle {
namespace {

constexpr float inf = std::numeric_limits<float>::infinity();

TreeNode split(std::int32_t feature, float threshold, std::int32_t left) {
  return {feature, left, threshold};
}
TreeNode leaf(float value) { return {-1, 0, value}; }

// x0 < 1 ? (x1 < -2 ? 10 : 20) : 30
std::vector<TreeNode> small_tree() { return {split(0, 1, 1), split(1, -2, 3), leaf(30), leaf(10), leaf(20)}; }

double value_at(const Trees& trees, double x0, double x1, Eigen::Index output = 0) {
  Table inputs(1, 2);
  inputs << x0, x1;
  Table outputs(1, static_cast<Eigen::Index>(trees.n_outputs()));
  trees.evaluate(inputs, outputs);
  return outputs(0, output);
}

// A random tree of the given depth, leaves at any level, behind what is in `nodes`. @return its root
std::int32_t grow(std::vector<TreeNode>& nodes, int depth, std::size_t n_inputs, base::Random& random) {
  const auto root = static_cast<std::int32_t>(nodes.size());
  nodes.push_back(leaf(0));
  std::vector<std::pair<std::size_t, int>> open{{nodes.size() - 1, 0}};
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto [at, level] = open[i];
    if (level == depth || (level > 1 && random.uniform() < 0.2)) {
      nodes[at] = leaf(static_cast<float>(random.normal()));
      continue;
    }
    const auto left = static_cast<std::int32_t>(nodes.size());
    nodes[at] =
        split(static_cast<std::int32_t>(random.below(n_inputs)), static_cast<float>(random.normal()), left);
    nodes.insert(nodes.end(), 2, leaf(0));
    open.emplace_back(left, level + 1);
    open.emplace_back(left + 1, level + 1);
  }
  return root;
}

// Straight from the header's words.
double walk(const std::vector<TreeNode>& nodes, const TreeGroup& group, const Eigen::ArrayXd& x) {
  double sum = group.base;
  for (const auto root : group.roots) {
    auto node = nodes[static_cast<std::size_t>(root)];
    while (node.feature >= 0)
      node = nodes[static_cast<std::size_t>(node.left +
                                            (static_cast<float>(x[node.feature]) >= node.value ? 1 : 0))];
    sum += static_cast<double>(node.value);
  }
  return sum;
}

Trees forest(std::size_t n_inputs = 5) {
  base::Random random(base::Seed(3));
  std::vector<TreeNode> nodes;
  std::vector<TreeGroup> outputs(3);
  for (std::size_t k = 0; k < outputs.size(); ++k) {
    outputs[k].base = 0.1 * static_cast<double>(k);
    for (int t = 0; t < 7; ++t)
      outputs[k].roots.push_back(grow(nodes, 2 + static_cast<int>(k) * 3, n_inputs, random));
  }
  return {n_inputs, nodes, outputs};
}

Table random_table(Eigen::Index rows, Eigen::Index columns) {
  base::Random random(base::Seed(8));
  Table table(rows, columns);
  for (auto& x : table.reshaped()) x = random.normal();
  return table;
}

TEST(Trees, SamplesBelowTheThresholdGoLeft) {
  const Trees trees(2, small_tree(), {{0.5, {0}}});

  EXPECT_EQ(value_at(trees, 0.999, -2.001), 10.5);
  EXPECT_EQ(value_at(trees, 0.999, -2), 20.5) << "on the threshold: right";
  EXPECT_EQ(value_at(trees, 1, -5), 30.5);
}

TEST(Trees, AnyInputEndsInALeaf) {
  const Trees trees(2, small_tree(), {{0, {0}}});

  EXPECT_EQ(value_at(trees, NAN, NAN), 10);
  EXPECT_EQ(value_at(trees, inf, inf), 30);
  EXPECT_EQ(value_at(trees, -1e300, 1e300), 20);
}

TEST(Trees, ManySamplesGiveWhatOneByOneWalksGive) {
  const auto trees = forest();
  const Eigen::Index n = 256 * 2 + 39;  // blocks, lanes and a rest
  const auto inputs = random_table(n, 5);
  Table outputs(n, 3);

  trees.evaluate(inputs, outputs);

  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index k = 0; k < 3; ++k)
      ASSERT_EQ(outputs(i, k),
                walk(trees.nodes(), trees.outputs()[static_cast<std::size_t>(k)], inputs.row(i).transpose()))
          << i << " " << k;
}

TEST(Trees, APartOfATableIsEvaluatedInPlace) {
  const auto trees = forest();
  const auto inputs = random_table(100, 5);
  Table outputs = Table::Constant(100, 3, 7), all(100, 3);
  trees.evaluate(inputs, all);

  trees.evaluate(inputs.middleRows(10, 45), outputs.middleRows(10, 45));

  EXPECT_TRUE((outputs.middleRows(10, 45) == all.middleRows(10, 45)).all());
  EXPECT_TRUE((outputs.topRows(10) == 7).all() && (outputs.bottomRows(45) == 7).all());
}

TEST(Trees, AFileKeepsThem) {
  const test::TemporaryFolder folder;
  const auto trees = forest();
  io::TensorFile file;
  trees.write(file, "model/low");
  file.write(folder / "trees.elrom");

  const auto back = read_regressor(io::TensorFile::open(folder / "trees.elrom"), "model/low");

  ASSERT_EQ(back->kind(), "trees");
  EXPECT_EQ(back->n_inputs(), 5U);
  EXPECT_EQ(back->n_outputs(), 3U);
  const auto inputs = random_table(300, 5);
  Table before(300, 3), after(300, 3);
  trees.evaluate(inputs, before);
  back->evaluate(inputs, after);
  EXPECT_TRUE((before == after).all());
}

TEST(Trees, WhatCannotBeEvaluatedSafelyIsRefused) {
  const auto make = [](std::vector<TreeNode> nodes, std::vector<TreeGroup> outputs = {{0, {0}}}) {
    return Trees(2, std::move(nodes), std::move(outputs));
  };
  auto nodes = small_tree();
  nodes[1].left = 0;
  EXPECT_ERROR(InputError, "node 1 has its children at 0", make(nodes));
  nodes[1].left = 1;
  EXPECT_ERROR(InputError, "node 1 has its children at 1", make(nodes));
  nodes[1].left = 4;
  EXPECT_ERROR(InputError, "node 1 has its children at 4", make(nodes));
  nodes[1].left = std::numeric_limits<std::int32_t>::max();
  EXPECT_ERROR(InputError, "node 1 has its children at 2147483647", make(nodes));
  nodes[1].left = 2;
  EXPECT_ERROR(InputError, "node 2 has two parents", make(nodes));
  nodes = small_tree();
  nodes[1].feature = 2;
  EXPECT_ERROR(InputError, "node 1 asks for input 2 of 2", make(nodes));
  nodes = small_tree();
  nodes[0].value = inf;
  EXPECT_ERROR(InputError, "node 0 has a value that is not finite", make(nodes));
  nodes = small_tree();
  nodes[4].value = NAN;
  EXPECT_ERROR(InputError, "node 4 has a value that is not finite", make(nodes));
  nodes = small_tree();
  nodes.push_back(leaf(1));
  EXPECT_ERROR(InputError, "node 5 belongs to no tree", make(nodes));
  EXPECT_ERROR(InputError, "root is no node", make(small_tree(), {{0, {5}}}));
  EXPECT_ERROR(InputError, "root is no node", make(small_tree(), {{0, {-1}}}));
  EXPECT_ERROR(InputError, "node 0 has two parents", make(small_tree(), {{0, {0, 0}}}));
  EXPECT_ERROR(InputError, "node 3 has two parents", make(small_tree(), {{0, {0, 3}}}));
  EXPECT_ERROR(InputError, "without a tree", make(small_tree(), {{0, {0}}, {0, {}}}));
  EXPECT_ERROR(InputError, "base is not finite", make(small_tree(), {{INFINITY, {0}}}));
  EXPECT_ERROR(InputError, "without an output", make({}, {}));
  EXPECT_ERROR(InputError, "number of inputs", Trees(0, small_tree(), {{0, {0}}}));
}

TEST(Trees, FilesWhoseTablesDoNotFitAreRefused) {
  io::TensorFile good;
  Trees(2, small_tree(), {{0, {0}}}).write(good, "m");
  const auto with = [&](const std::string& name, std::vector<std::int32_t> values) {
    auto file = good;
    file.set("m/" + name, io::Tensor::copy(std::span<const std::int32_t>(values), {values.size()}));
    return file;
  };
  EXPECT_NO_THROW((void)Trees::read(good, "m"));
  EXPECT_THROW((void)Trees::read(with("left", {1, 3, 0, 0}), "m"), InputError);
  EXPECT_THROW((void)Trees::read(with("value", {0, 0, 0, 0, 0}), "m"), InputError) << "another type";
  EXPECT_ERROR(InputError, "more trees than roots", Trees::read(with("trees", {2}), "m"));
  EXPECT_ERROR(InputError, "more trees than roots", Trees::read(with("trees", {-1}), "m"));
  EXPECT_ERROR(InputError, "roots of no output", Trees::read(with("roots", {0, 2}), "m"));
  auto file = good;
  for (const auto* inputs : {"0", "1.5", "-1", "1e9", "nan", "two"}) {
    file.set_text("m/inputs", inputs);
    EXPECT_ERROR(InputError, "number of inputs", Trees::read(file, "m"));
  }
}

TEST(Regressor, AnUnknownKindIsRefusedByName) {
  io::TensorFile file;
  file.set_text("m/kind", "tree");

  EXPECT_ERROR(InputError, "did you mean 'trees'", read_regressor(file, "m"));
  EXPECT_THROW((void)read_regressor(file, "other"), InputError);
}

}  // namespace
}  // namespace elrom::particle
