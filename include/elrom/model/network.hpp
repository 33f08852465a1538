#pragma once
// Forward pass of a multilayer perceptron; weights are views into a bundle or owned by the trainer's result.

#include <string>
#include <string_view>
#include <vector>

#include "elrom/io/tensor_file.hpp"
#include "elrom/math/matrix.hpp"
#include "elrom/model/field_model.hpp"

namespace elrom::model {

enum class Activation { relu, tanh, silu };
[[nodiscard]] std::string_view name_of(Activation activation);
/// @throws InputError with the known names
[[nodiscard]] Activation activation_of(std::string_view name);

struct Layer {
  io::Tensor weights;  //!< (n_out, n_in)
  io::Tensor bias;     //!< (n_out)
};

/// y = W_L a(... a(W_1 x + b_1) ...) + b_L; the activation follows every layer but the last.
/// Thread rule: const use from any thread, each with its own Workspace.
class Network {
 public:
  Network() = default;
  /// @throws InputError when consecutive layers do not fit
  Network(std::vector<Layer> layers, Activation activation);

  [[nodiscard]] std::size_t n_inputs() const;
  [[nodiscard]] std::size_t n_outputs() const;
  [[nodiscard]] const std::vector<Layer>& layers() const { return layers_; }
  [[nodiscard]] Activation activation() const { return activation_; }

  /// @param x (n, n_inputs) @param y (n, n_outputs). A row's result does not depend on the other rows, to the bit.
  void forward(const Eigen::Ref<const MatrixF>& x, Eigen::Ref<MatrixF> y, Workspace& workspace) const;

  void save(io::TensorFile& file, const std::string& prefix) const;
  [[nodiscard]] static Network load(const io::TensorFile& file, const std::string& prefix);

 private:
  std::vector<Layer> layers_;
  Activation activation_ = Activation::relu;
};

}  // namespace elrom::model
