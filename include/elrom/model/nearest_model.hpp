#pragma once
// The training case nearest in standardised inputs, as it is: the simplest peer.

#include <string>
#include <vector>

#include "elrom/math/matrix.hpp"
#include "elrom/math/standardiser.hpp"
#include "elrom/model/field_model.hpp"

namespace elrom::model {

/// Thread rule: const use from any number of threads.
class NearestModel final : public FieldModel {
 public:
  /// @param inputs standardised training inputs, (n_cases, n_inputs) @param values SI, (n_cases, n_cells) f32
  /// @throws InputError when shapes do not fit each other
  NearestModel(math::Standardiser scaler, MatrixD inputs, io::Tensor values, std::size_t n_columns,
               const std::string& where = "memory");

  [[nodiscard]] std::string kind() const override { return "nearest"; }
  [[nodiscard]] std::size_t n_inputs() const override { return static_cast<std::size_t>(scaler_.size()); }
  [[nodiscard]] std::size_t n_planes() const override { return values_.shape()[1] / n_columns_; }
  [[nodiscard]] std::size_t n_columns() const override { return n_columns_; }
  /// Index of the training case that answers; the first of equally near ones.
  [[nodiscard]] std::size_t nearest(std::span<const double> inputs, Workspace& workspace) const;
  /// The model knows no spread of its own: `spread` is set to zero.
  void predict(const Query& query, std::span<float> values, std::span<float> spread,
               Workspace& workspace) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<FieldModel> load(const io::TensorFile& file, const std::string& prefix,
                                                        const Wanted& wanted);

 private:
  math::Standardiser scaler_;
  MatrixD inputs_;
  io::Tensor values_;
  std::size_t n_columns_;
};

}  // namespace elrom::model
