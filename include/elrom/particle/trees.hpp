#pragma once
// Boosted regression trees, flat and ready to evaluate: no XGBoost needed.
//
// All trees' nodes lie in one array. A node with feature >= 0 sends x[feature] >= threshold to left + 1 and all
// else (NaN too) to `left`: children lie beside each other. One with feature < 0 is a leaf that adds `value`.
// Children lie behind their parent, and every node is a root or the child of one node, so that evaluation
// takes no more steps than there are nodes, for any file that read() accepts.
// Inputs are compared as floats, as XGBoost sees them. Sums are formed in double from float leaves in the
// trees' order, plus a base value for each output.

#include <cstdint>
#include <span>
#include <vector>

#include "elrom/particle/regressor.hpp"

namespace elrom::particle {

struct TreeNode {
  std::int32_t feature = -1;  ///< of the inputs; < 0: a leaf
  std::int32_t left = 0;      ///< index of the child for x < threshold
  float value = 0;            ///< threshold, or the leaf's value
  bool operator==(const TreeNode&) const = default;
};

/// One output a group of trees: what XGBoost calls one model.
struct TreeGroup {
  double base = 0;
  std::vector<std::int32_t> roots;  ///< one a tree, indices into the nodes; at least one
};

class Trees final : public Regressor {
 public:
  static constexpr std::size_t most_inputs = 1024;

  /// @param where for messages: file and prefix
  /// @throws InputError naming the first node that breaks the rules above, or what else does not fit
  Trees(std::size_t n_inputs, std::vector<TreeNode> nodes, std::vector<TreeGroup> outputs,
        const std::string& where = "trees");

  [[nodiscard]] std::string kind() const override { return "trees"; }
  [[nodiscard]] std::size_t n_inputs() const override { return n_inputs_; }
  [[nodiscard]] std::size_t n_outputs() const override { return outputs_.size(); }
  [[nodiscard]] std::size_t n_trees() const;
  [[nodiscard]] const std::vector<TreeNode>& nodes() const { return nodes_; }
  [[nodiscard]] const std::vector<TreeGroup>& outputs() const { return outputs_; }
  /// Every sample on its own: the same bits alone or among others. Allocates some kB a call.
  void evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const override;
  void write(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<Trees> read(const io::TensorFile& file, const std::string& prefix);

 private:
  // What evaluation reads of a node. A leaf sends every sample to itself, so that all samples of a tree take as
  // many steps as its deepest leaf asks for, without a branch.
  struct Step {
    std::int32_t input, left;  // input: where the feature's values begin in a block
    float threshold, leaf;
  };
  void sum_trees(const TreeGroup& output, std::span<const float> block, std::span<double> sums) const;

  std::size_t n_inputs_;
  std::vector<TreeNode> nodes_;
  std::vector<TreeGroup> outputs_;
  std::vector<Step> steps_;           // one a node
  std::vector<std::int32_t> depths_;  // of the tree at each root; 0 at other nodes
};

}  // namespace elrom::particle
