#pragma once
// Scores of a predicted field against the truth, and the held-out cases that they are taken on: the one
// computation behind reports and the gate, as pure functions on numbers.
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

#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::study {

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

/// Held-out rows of a store by what they are used for.
struct JudgedCases {
  std::vector<std::size_t> scored;                ///< those that are no repeated runs
  std::vector<std::vector<std::size_t>> repeats;  ///< sets of runs of the same boundary conditions
};
/// A repeated run (field::Furnace::repeats) tells the noise of the truth and is not scored: its load would
/// count twice.
[[nodiscard]] JudgedCases judged_cases(const field::SnapshotStore& store,
                                       const std::vector<std::size_t>& held_out);

}  // namespace elrom::study
