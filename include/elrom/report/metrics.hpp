#pragma once
// What a report scores beyond elrom/study/scores.hpp, whose NRMSE is the one here too: as pure functions on
// numbers.
//
// Thread rule: pure functions.

#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "elrom/math/matrix.hpp"
#include "elrom/study/scores.hpp"

namespace elrom::report {

using study::error_sums;
using study::ErrorSums;
using study::noise_at_loads;
using study::noise_energy;
using study::training_statistics;
using study::TrainingStatistics;

/// A score of what nothing is known of.
inline constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

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

/// NRMSE with the noise of the truth taken off error and departure alike:
/// sqrt((error - noise) / (departure - noise)). NaN where there is no more error than noise (taken for 0, it
/// would promise a perfect model), or the truth departs from the mean by noise alone.
/// @param noise energy in all cases summed in `sums`
[[nodiscard]] double nrmse_without_noise(const ErrorSums& sums, double noise);

/// The root of error / departure with the sign of the error: an estimate from which noise was taken off may
/// lie below nothing, and to call it 0 would promise a perfect model. NaN for a departure that is not above
/// 0.
[[nodiscard]] double signed_nrmse(double error, double departure);

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
