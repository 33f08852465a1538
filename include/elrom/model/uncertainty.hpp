#pragma once
// Prediction intervals of one field: cross-conformal scores (Vovk 2015; Barber et al. 2021), normalised by
// the error expected of a cell and of a case (Papadopoulos et al. 2008). half-width(case, cell, level) =
// quantile(level) * factor(case) * scale(cell). Scale is the root mean square of cross-validated residuals;
// factor is log-linear in the inputs, a ridge fit to the cases' own root mean squares: the noise of an
// average grows with the velocities, so one width for all loads would be too wide at low load. The promise
// (coverage on average over cells and over cases exchangeable with the training set) is void outside it.

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
  /// @param inputs of those cases, SI, (n_calibration_cases, n_inputs); empty: every case has the factor 1
  Uncertainty(const MatrixF& residuals, std::size_t n_columns, const MatrixD& inputs = {});

  /// @param level in (0, 1), e.g. 0.9. @throws UsageError outside, or where so few cases cannot promise it
  [[nodiscard]] double quantile(double level) const;
  [[nodiscard]] std::size_t n_cases() const { return n_cases_; }
  /// Inputs that factor() takes; 0: any.
  [[nodiscard]] std::size_t n_inputs() const { return growth_.size(); }
  /// How large the error of this case is expected to be beside that of a typical one; between the smallest
  /// and the largest of the calibration cases, whatever the inputs. @param inputs SI, (n_inputs)
  [[nodiscard]] double factor(std::span<const double> inputs) const;
  /// Standard deviation expected of a typical case's error in each cell, (planes.size() * n_columns)
  void scale(std::span<const std::int32_t> planes, std::span<float> out) const;

  void save(io::TensorFile& file, const std::string& prefix) const;
  [[nodiscard]] static Uncertainty load(const io::TensorFile& file, const std::string& prefix);

 private:
  io::Tensor scale_;                        //!< (n_planes, n_columns)
  std::vector<double> levels_, quantiles_;  //!< table of the pooled scores' conformal quantiles
  std::vector<double> growth_;  //!< of the factor's logarithm with each input, (n_inputs); empty: factor 1
  double offset_ = 0, least_ = 0, most_ = 0;  //!< of the factor's logarithm
  std::size_t n_cases_ = 0;
};

}  // namespace elrom::model
