#include "elrom/report/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::report {

WorstCell worst_cell(std::span<const float> truth, std::span<const float> prediction) {
  check(truth.size() == prediction.size() && !truth.empty(), "worst_cell: sizes differ");
  WorstCell worst{0, truth[0], prediction[0]};
  double largest = -1;
  for (std::size_t cell = 0; cell < truth.size(); ++cell) {
    const double difference = std::abs(double{prediction[cell]} - double{truth[cell]});
    const double size = std::isfinite(difference) ? difference : std::numeric_limits<double>::infinity();
    if (size <= largest) continue;
    largest = size;
    worst = {cell, truth[cell], prediction[cell]};
  }
  return worst;
}

double covered_share(std::span<const float> truth, std::span<const float> prediction,
                     std::span<const float> half_width) {
  check(truth.size() == prediction.size() && truth.size() == half_width.size(),
        "covered_share: sizes differ");
  std::size_t covered = 0;
  for (std::size_t cell = 0; cell < truth.size(); ++cell)
    if (std::abs(double{prediction[cell]} - double{truth[cell]}) <= half_width[cell]) ++covered;
  return truth.empty() ? undefined : static_cast<double>(covered) / static_cast<double>(truth.size());
}

double nrmse_without_noise(const ErrorSums& sums, double noise) {
  return sums.error > noise ? math::nrmse(sums.error - noise, sums.departure - noise) : undefined;
}

double signed_nrmse(double error, double departure) {
  return departure > 0 ? std::copysign(std::sqrt(std::abs(error) / departure), error) : undefined;
}

CaseSpan::CaseSpan(const MatrixF& values) {
  const Eigen::Index n_cases = values.rows();
  MatrixD centred = values.cast<double>();
  const Eigen::RowVectorXd mean = centred.colwise().mean();
  mean_.assign(mean.data(), mean.data() + mean.size());
  centred.rowwise() -= mean;
  // Modes by the small Gram matrix (method of snapshots, Sirovich
  // 1987); tiny eigenvalues are rounding, not modes.
  const math::SymmetricEigen eigen = math::symmetric_eigen(centred * centred.transpose());
  constexpr double negligible = 1e-10;
  const double floor = negligible * std::max(0.0, eigen.values.maxCoeff());
  const auto n_modes = static_cast<Eigen::Index>((eigen.values.array() > floor).count());
  modes_.resize(n_modes, centred.cols());
  for (Eigen::Index k = 0; k < n_modes; ++k) {
    const Eigen::Index column = n_cases - 1 - k;  // eigenvalues ascend
    modes_.row(k) = eigen.vectors.col(column).transpose() * centred / std::sqrt(eigen.values(column));
  }
}

std::vector<double> CaseSpan::residuals(std::span<const float> truth) const {
  check(truth.size() == mean_.size(), "CaseSpan: sizes differ");
  Eigen::VectorXd departure(static_cast<Eigen::Index>(truth.size()));
  for (std::size_t cell = 0; cell < truth.size(); ++cell)
    departure(static_cast<Eigen::Index>(cell)) = double{truth[cell]} - mean_[cell];
  const Eigen::VectorXd coefficients = modes_ * departure;
  std::vector<double> residuals{departure.squaredNorm()};
  for (const double coefficient : coefficients)
    residuals.push_back(std::max(0.0, residuals.back() - coefficient * coefficient));
  return residuals;
}

ErrorBudget error_budget(const ErrorSums& sums, double noise, double residual) {
  if (!(sums.departure > 0)) return {};
  ErrorBudget budget;
  budget.noise = std::min(noise, sums.error) / sums.departure;
  const double left = std::max(0.0, sums.error - noise);
  budget.compression = std::min(std::max(0.0, residual - noise), left) / sums.departure;
  budget.regression = sums.error / sums.departure - budget.noise - budget.compression;
  return budget;
}

}  // namespace elrom::report
