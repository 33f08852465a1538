#include "elrom/particle/trees.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::particle {
namespace {

constexpr std::size_t samples_at_once = 256;  // samples; one tree and a block stay in the nearest cache
constexpr std::size_t n_lanes = 8;            // samples that go down a tree side by side, to hide the loads
static_assert(samples_at_once % n_lanes == 0);

[[noreturn]] void refuse(const std::string& where, std::size_t node, std::string what) {
  throw InputError({.what = "node " + std::to_string(node) + " " + std::move(what), .where = where});
}

// Marks every child and root, each once, and gives the depth of every node.
class Shape {
 public:
  Shape(const std::vector<TreeNode>& nodes, const std::string& where)
      : nodes_(nodes), where_(where), depth_(nodes.size(), -1) {}

  void add_root(std::int32_t root) {
    if (root < 0 || static_cast<std::size_t>(root) >= nodes_.size())
      throw InputError({.what = "a tree's root is no node",
                        .where = where_,
                        .found = std::to_string(root),
                        .expected = "0 to " + std::to_string(nodes_.size()) + ", exclusive"});
    claim(static_cast<std::size_t>(root), 0);
  }

  void walk(std::size_t n_inputs) {
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const auto& node = nodes_[i];
      if (depth_[i] < 0) refuse(where_, i, "belongs to no tree");
      if (!std::isfinite(node.value)) refuse(where_, i, "has a value that is not finite");
      if (node.feature < 0) continue;
      if (static_cast<std::size_t>(node.feature) >= n_inputs)
        refuse(where_, i,
               "asks for input " + std::to_string(node.feature) + " of " + std::to_string(n_inputs));
      const auto left = static_cast<std::int64_t>(node.left);
      if (left <= static_cast<std::int64_t>(i) || left + 1 >= static_cast<std::int64_t>(nodes_.size()))
        refuse(where_, i, "has its children at " + std::to_string(left) + ": not behind it, or no nodes");
      claim(static_cast<std::size_t>(left), depth_[i] + 1);
      claim(static_cast<std::size_t>(left) + 1, depth_[i] + 1);
    }
  }

  [[nodiscard]] const std::vector<std::int32_t>& depth() const { return depth_; }

 private:
  void claim(std::size_t node, std::int32_t depth) {
    if (depth_[node] >= 0) refuse(where_, node, "has two parents, or is a root with a parent");
    depth_[node] = depth;
  }

  const std::vector<TreeNode>& nodes_;
  const std::string& where_;
  std::vector<std::int32_t> depth_;
};

std::vector<std::int32_t> numbers(const io::TensorFile& file, const std::string& name) {
  const auto values = file.tensor(name, std::array{io::any_size}).i32();
  return {values.begin(), values.end()};
}

}  // namespace

Trees::Trees(std::size_t n_inputs, std::vector<TreeNode> nodes, std::vector<TreeGroup> outputs,
             const std::string& where)
    : n_inputs_(n_inputs), nodes_(std::move(nodes)), outputs_(std::move(outputs)) {
  if (n_inputs_ == 0 || n_inputs_ > most_inputs)
    throw InputError({.what = "number of inputs of trees",
                      .where = where,
                      .found = std::to_string(n_inputs_),
                      .expected = "1 to " + std::to_string(most_inputs)});
  if (nodes_.size() > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
    throw InputError({.what = "more nodes than can be numbered", .where = where});
  if (outputs_.empty()) throw InputError({.what = "trees without an output", .where = where});
  Shape shape(nodes_, where);
  for (const auto& output : outputs_) {
    if (output.roots.empty() || !std::isfinite(output.base))
      throw InputError({.what = "an output without a tree, or whose base is not finite", .where = where});
    for (const auto root : output.roots) shape.add_root(root);
  }
  shape.walk(n_inputs_);

  depths_.resize(nodes_.size());
  steps_.reserve(nodes_.size());
  std::vector<std::int32_t> root_of(nodes_.size());
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto& node = nodes_[i];
    const auto self = static_cast<std::int32_t>(i);
    if (shape.depth()[i] == 0) root_of[i] = self;
    auto& deepest = depths_[static_cast<std::size_t>(root_of[i])];
    deepest = std::max(deepest, shape.depth()[i]);
    const bool is_leaf = node.feature < 0;
    if (is_leaf)
      steps_.push_back({0, self, std::numeric_limits<float>::quiet_NaN(), node.value});
    else
      steps_.push_back({node.feature * static_cast<std::int32_t>(samples_at_once), node.left, node.value, 0});
    if (!is_leaf)
      for (const int child : {0, 1}) root_of[static_cast<std::size_t>(node.left + child)] = root_of[i];
  }
}

std::size_t Trees::n_trees() const {
  std::size_t n = 0;
  for (const auto& output : outputs_) n += output.roots.size();
  return n;
}

// Gathers, which GCC would make of the lanes, take 1.5 to 2 times as long as these loads (Zen 4).
#if defined(__GNUC__) && !defined(__clang__)
__attribute__((optimize("no-tree-vectorize")))
#endif
void Trees::sum_trees(const TreeGroup& output, std::span<const float> block, std::span<double> sums) const {
  const Step* steps = steps_.data();
  std::ranges::fill(sums, output.base);
  for (const auto root : output.roots) {
    const auto depth = depths_[static_cast<std::size_t>(root)];
    for (std::size_t first = 0; first < sums.size(); first += n_lanes) {
      const float* x = block.data() + first;
      std::array<std::int32_t, n_lanes> at;
      at.fill(root);
      for (std::int32_t step = 0; step < depth; ++step)
        for (std::size_t l = 0; l < n_lanes; ++l) {
          const Step& node = steps[at[l]];
          const bool right = x[static_cast<std::size_t>(node.input) + l] >= node.threshold;
          at[l] = node.left + static_cast<std::int32_t>(right);
        }
      for (std::size_t l = 0; l < n_lanes; ++l) sums[first + l] += static_cast<double>(steps[at[l]].leaf);
    }
  }
}

void Trees::evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const {
  check(static_cast<std::size_t>(inputs.cols()) == n_inputs_, "trees: number of inputs");
  check(outputs.rows() == inputs.rows() && static_cast<std::size_t>(outputs.cols()) == outputs_.size(),
        "trees: shape of the outputs");
  const auto n = static_cast<std::size_t>(inputs.rows());
  std::vector<float> block(n_inputs_ * samples_at_once);
  std::array<double, samples_at_once> sums;
  for (std::size_t first = 0; first < n; first += samples_at_once) {
    const auto count = std::min(samples_at_once, n - first);
    const auto row = static_cast<Eigen::Index>(first), rows = static_cast<Eigen::Index>(count);
    for (std::size_t k = 0; k < n_inputs_; ++k)
      Eigen::Map<Eigen::ArrayXf>(block.data() + k * samples_at_once, rows) =
          inputs.col(static_cast<Eigen::Index>(k)).segment(row, rows).cast<float>();
    const auto in_lanes = (count + n_lanes - 1) / n_lanes * n_lanes;
    for (std::size_t k = 0; k < outputs_.size(); ++k) {
      sum_trees(outputs_[k], block, std::span(sums).first(in_lanes));
      std::copy_n(sums.begin(), count, &outputs(row, static_cast<Eigen::Index>(k)));
    }
  }
}

void Trees::write(io::TensorFile& file, const std::string& prefix) const {
  std::vector<std::int32_t> feature, left, roots, n_trees;
  std::vector<float> value;
  std::vector<double> base;
  for (const auto& node : nodes_) {
    feature.push_back(node.feature);
    left.push_back(node.left);
    value.push_back(node.value);
  }
  for (const auto& output : outputs_) {
    roots.insert(roots.end(), output.roots.begin(), output.roots.end());
    n_trees.push_back(static_cast<std::int32_t>(output.roots.size()));
    base.push_back(output.base);
  }
  const auto set = [&](const char* name, const auto& values) {
    using Value = typename std::decay_t<decltype(values)>::value_type;
    file.set(prefix + name, io::Tensor::copy(std::span<const Value>(values), {values.size()}));
  };
  file.set_text(prefix + "/kind", kind());
  file.set_text(prefix + "/inputs", std::to_string(n_inputs_));
  set("/feature", feature);
  set("/left", left);
  set("/value", value);
  set("/roots", roots);
  set("/trees", n_trees);
  set("/base", base);
}

std::unique_ptr<Trees> Trees::read(const io::TensorFile& file, const std::string& prefix) {
  const std::string where = file.where() + ":" + prefix;
  const auto inputs = base::to_double(file.text(prefix + "/inputs"));
  if (!inputs || !(*inputs >= 1) || *inputs > most_inputs || *inputs != std::floor(*inputs))
    throw InputError({.what = "number of inputs of trees",
                      .where = where,
                      .found = "'" + file.text(prefix + "/inputs") + "'",
                      .expected = "1 to " + std::to_string(most_inputs)});
  const auto feature = file.tensor(prefix + "/feature", std::array{io::any_size}).i32();
  const std::array same{feature.size()};
  const auto left = file.tensor(prefix + "/left", same).i32();
  const auto value = file.tensor(prefix + "/value", same).f32();
  const auto n_trees = numbers(file, prefix + "/trees"), roots = numbers(file, prefix + "/roots");
  const auto base = file.tensor(prefix + "/base", std::array{n_trees.size()}).f64();

  std::vector<TreeNode> nodes(feature.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i] = {feature[i], left[i], value[i]};
  std::vector<TreeGroup> outputs;
  std::size_t used = 0;
  for (std::size_t k = 0; k < n_trees.size(); ++k) {
    const bool fits = n_trees[k] > 0 && static_cast<std::size_t>(n_trees[k]) <= roots.size() - used;
    if (!fits)
      throw InputError({.what = "more trees than roots, or none of an output",
                        .where = where,
                        .found = std::to_string(n_trees[k])});
    const auto begin = roots.begin() + static_cast<std::ptrdiff_t>(used);
    outputs.push_back({base[k], {begin, begin + n_trees[k]}});
    used += static_cast<std::size_t>(n_trees[k]);
  }
  if (used != roots.size()) throw InputError({.what = "roots of no output's tree", .where = where});
  return std::make_unique<Trees>(static_cast<std::size_t>(*inputs), std::move(nodes), std::move(outputs),
                                 where);
}

}  // namespace elrom::particle
