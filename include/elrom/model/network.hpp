#pragma once
// Forward pass of a multilayer perceptron; weights are views into a bundle or owned by the trainer's result.

#include <span>
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
  io::Tensor weights;  //!< (n_out, n_in), float32, or float16 to halve a bundle
  io::Tensor bias;     //!< (n_out), float32
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

  /// @param x (n, n_inputs) @param y (n, n_outputs). A row's
  /// result does not depend on the other rows, to the bit.
  void forward(const Eigen::Ref<const MatrixF>& x, Eigen::Ref<MatrixF> y, Workspace& workspace) const;

  /// The same for rows whose first inputs are equal (the planes of one case): their part of the first layer
  /// is computed once. Works on transposed rows, padded to a multiple of 16; what the padding holds only has
  /// to be finite. A row's result equals to the bit for any number and order of rows.
  /// @param shared first inputs, (n_shared), n_shared <= n_inputs
  /// @param own the other inputs, (n_inputs - n_shared, padded n_rows), 64-byte aligned
  /// @param out (n_outputs, padded n_rows), 64-byte aligned
  void forward_shared(std::span<const float> shared, std::span<const float> own, std::size_t n_rows,
                      std::span<float> out, Workspace& workspace) const;

  /// The same network with weights in float16 (about three significant digits; half the bytes).
  [[nodiscard]] Network halved() const;

  void save(io::TensorFile& file, const std::string& prefix) const;
  [[nodiscard]] static Network load(const io::TensorFile& file, const std::string& prefix);

 private:
  /// Bias plus the shared inputs' part of the first layer, (n_out of layer 1)
  [[nodiscard]] std::span<const float> first_layer_start(std::span<const float> shared,
                                                         Workspace& workspace) const;

  std::vector<Layer> layers_;
  Activation activation_ = Activation::relu;
};

}  // namespace elrom::model
