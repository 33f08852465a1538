#pragma once
// Boosted regression trees, flat and ready to evaluate: no XGBoost needed.
//
// All trees' nodes lie in one array. A node with feature >= 0 sends x[feature] < threshold to `left`, else to
// left + 1 (children lie beside each other); one with feature < 0 is a leaf that adds `value`. Children lie
// behind their parent, so evaluation ends for any file that read() accepts.
// Sums are formed in double from float leaves in the trees' order, plus a base value for each output.

#include <cstdint>
#include <vector>

#include "elrom/particle/regressor.hpp"

namespace elrom::particle {

struct TreeNode {
  std::int32_t feature = -1;  ///< of the inputs; < 0: a leaf
  std::int32_t left = 0;      ///< index of the child for x < threshold
  float value = 0;            ///< threshold, or the leaf's value
};

/// One output a group of trees: what XGBoost calls one model.
struct TreeGroup {
  double base = 0;
  std::vector<std::int32_t> roots;  ///< one a tree, indices into the nodes
};

class Trees final : public Regressor {
 public:
  /// @throws InputError naming the first node that breaks the rules above
  Trees(std::size_t n_inputs, std::vector<TreeNode> nodes, std::vector<TreeGroup> outputs);

  [[nodiscard]] std::string kind() const override { return "trees"; }
  [[nodiscard]] std::size_t n_inputs() const override { return n_inputs_; }
  [[nodiscard]] std::size_t n_outputs() const override { return outputs_.size(); }
  [[nodiscard]] std::size_t n_trees() const;
  void evaluate(const Eigen::Ref<const Table>& inputs, Eigen::Ref<Table> outputs) const override;
  void write(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<Trees> read(const io::TensorFile& file, const std::string& prefix);

 private:
  std::size_t n_inputs_;
  std::vector<TreeNode> nodes_;
  std::vector<TreeGroup> outputs_;
};

}  // namespace elrom::particle
