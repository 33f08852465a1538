#pragma once
// Prediction intervals of one field: cross-conformal scores on a per-cell scale (Vovk 2015; Barber et al. 2021).
// half-width(cell, level) = quantile(level) * scale(cell); scale is the root mean square of cross-validated residuals.
// The promise (coverage on average over cells and over cases exchangeable with the training set) is void outside it.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "elrom/io/tensor_file.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::model {

class Uncertainty {
 public:
  Uncertainty() = default;
  /// @param residuals cross-validated truth minus prediction, (n_calibration_cases, n_cells), SI
  Uncertainty(const MatrixF& residuals, std::size_t n_columns);

  /// @param level in (0, 1), e.g. 0.9. @throws UsageError outside, or where so few cases cannot promise it
  [[nodiscard]] double quantile(double level) const;
  [[nodiscard]] std::size_t n_cases() const { return n_cases_; }
  /// Standard deviation expected of the error in each cell, (planes.size() * n_columns)
  void scale(std::span<const std::int32_t> planes, std::span<float> out) const;

  void save(io::TensorFile& file, const std::string& prefix) const;
  [[nodiscard]] static Uncertainty load(const io::TensorFile& file, const std::string& prefix);

 private:
  io::Tensor scale_;                 //!< (n_planes, n_columns)
  std::vector<double> levels_, quantiles_;  //!< table of the pooled scores' conformal quantiles
  std::size_t n_cases_ = 0;
};

}  // namespace elrom::model
