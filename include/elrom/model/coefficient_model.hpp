#pragma once
// What turns a case's inputs into the coefficients of a field's modes; the inner part of model::PodModel.
//
// Non-goals: fields and cells (PodModel), training (train/study).

#include <memory>
#include <span>
#include <string>

#include "elrom/io/tensor_file.hpp"
#include "elrom/model/field_model.hpp"

namespace elrom::model {

/// Thread rule: const use from any number of threads, each with a Workspace of its own.
class CoefficientModel {
 public:
  virtual ~CoefficientModel() = default;

  /// Names the reader in a file: "linear", "gp", "rbf", "mlp", "smoother".
  [[nodiscard]] virtual std::string kind() const = 0;
  [[nodiscard]] virtual std::size_t n_inputs() const = 0;
  [[nodiscard]] virtual std::size_t n_coefficients() const = 0;

  /// @param inputs SI, (n_inputs) @param coefficients (n_coefficients)
  /// @param variance of each coefficient's error as the model knows it, (n_coefficients); may be empty
  virtual void predict(std::span<const double> inputs, std::span<double> coefficients,
                       std::span<double> variance, bool best_build_only, Workspace& workspace) const = 0;

  /// Tensors under "<prefix>/...", description as JSON text under `prefix` with "kind".
  virtual void save(io::TensorFile& file, const std::string& prefix) const = 0;
};

/// Reads what save() wrote. @throws InputError for an unknown kind or a wrong shape, naming file and tensor
[[nodiscard]] std::unique_ptr<CoefficientModel> load_coefficient_model(const io::TensorFile& file,
                                                                       const std::string& prefix);

}  // namespace elrom::model
