#pragma once
// Scores of a predicted field against the truth, as pure functions on numbers.
//
// Definitions (held-out cases c, cells i, truth y, prediction p, mean m_i of the training cases):
//   NRMSE             sqrt( sum (p - y)^2 / sum (m - y)^2 ), sums over cells and over all cases scored
//                     together; 1 = predicting the training mean in every cell, 0 = perfect
//   standardised MSE  mean of ((p - y) / sigma_j)^2, sigma_j of output column j over training cases and
//                     planes (the source's figure, its eq. 6.1); columns that do not vary are left out
//   RMSE              sqrt( mean (p - y)^2 ), in the field's unit
//   R2                1 - sum (p - y)^2 / sum (y - mean y)^2, one mean for everything scored together
//                     (the parity plot's)
// Cells count alike, whatever their volume.
//
// Thread rule: pure functions.

#include <cstddef>
#include <span>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::report {

/// What the scores need to know of the training cases of one field.
struct TrainingStatistics {
  std::vector<double> cell_mean;     ///< over cases, (n_cells)
  std::vector<double> column_sigma;  ///< over cases and planes, (n_columns)
};

/// @param values (n_cases, n_cells), n_cells a multiple of n_columns
[[nodiscard]] TrainingStatistics training_statistics(const MatrixF& values, std::size_t n_columns);

/// Sums over the scored cells; add two to score them together.
struct ErrorSums {
  std::size_t n = 0;
  double error = 0;      ///< sum (p - y)^2
  double departure = 0;  ///< sum (m - y)^2
  std::size_t n_standardised = 0;
  double standardised = 0;  ///< sum ((p - y) / sigma)^2
  double truth_mean = 0;
  double truth_spread = 0;  ///< sum (y - mean y)^2

  ErrorSums& operator+=(const ErrorSums& other);
  /// NaN where nothing was scored or the truth does not depart from the mean.
  [[nodiscard]] double nrmse() const;
  [[nodiscard]] double standardised_mse() const;
  [[nodiscard]] double rmse() const;
  [[nodiscard]] double r2() const;
};

/// @param truth, prediction (n_cells)
/// @param part cells to score, empty: all
[[nodiscard]] ErrorSums error_sums(std::span<const float> truth, std::span<const float> prediction,
                                   const TrainingStatistics& statistics,
                                   std::span<const std::size_t> part = {});

struct WorstCell {
  std::size_t cell = 0;
  double truth = 0, prediction = 0;
};
/// The cell with the largest absolute error (the first of
/// equals; a value that is not finite counts as largest).
[[nodiscard]] WorstCell worst_cell(std::span<const float> truth, std::span<const float> prediction);

/// Share of cells with |p - y| <= half width.
[[nodiscard]] double covered_share(std::span<const float> truth, std::span<const float> prediction,
                                   std::span<const float> half_width);

/// Energy of the noise of one run: sum over cells of the unbiased
/// variance between runs of the same boundary conditions.
/// @param runs (n_runs >= 2, n_cells)
[[nodiscard]] double noise_energy(const MatrixF& runs);

/// Noise expected at other loads: a power law of the load through the measured ones (least squares in
/// logarithms; the fluctuations of a furnace grow with its velocities), their mean where loads or energies do
/// not allow one.
/// @param measured_loads, energies of each set of repeated
/// runs, at least one @return energy at each of `loads`
[[nodiscard]] std::vector<double> noise_at_loads(std::span<const double> measured_loads,
                                                 std::span<const double> energies,
                                                 std::span<const double> loads);

/// NRMSE with the noise of the truth taken off error and departure alike:
/// sqrt((error - noise) / (departure - noise)). NaN where there is no more error than noise (taken for 0, it
/// would promise a perfect model), or the truth departs from the mean by noise alone.
/// @param noise energy in all cases summed in `sums`
[[nodiscard]] double nrmse_without_noise(const ErrorSums& sums, double noise);

/// The training cases' span: how well any combination of them could represent a field.
class CaseSpan {
 public:
  /// @param values (n_cases, n_cells)
  explicit CaseSpan(const MatrixF& values);
  /// Energy of `truth` outside mean + the first r modes, for r = 0 ... n_modes(); never increases. (n_modes()
  /// + 1)
  [[nodiscard]] std::vector<double> residuals(std::span<const float> truth) const;
  [[nodiscard]] std::size_t n_modes() const { return static_cast<std::size_t>(modes_.rows()); }

 private:
  std::vector<double> mean_;
  MatrixD modes_;  //!< orthonormal, (n_modes, n_cells)
};

/// Where a field's error comes from, as shares of the departure from the mean: noise + compression +
/// regression = NRMSE^2.
struct ErrorBudget {
  double noise = 0;        ///< of the truth itself: averaging longer lowers it
  double compression = 0;  ///< outside every combination of the training cases: more cases lower it
  double regression = 0;   ///< the model's own: a better model, or more cases, lowers it
  [[nodiscard]] double nrmse_squared() const { return noise + compression + regression; }
};
/// @param residual energy of the scored cases outside the training cases' span (noise lies outside it too)
[[nodiscard]] ErrorBudget error_budget(const ErrorSums& sums, double noise, double residual);

}  // namespace elrom::report
