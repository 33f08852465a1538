#include "elrom/report/metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::report {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

// Welford's running mean and sum of squared departures.
struct Spread {
  double n = 0, mean = 0, squares = 0;
  void add(double value) {
    ++n;
    const double step = value - mean;
    mean += step / n;
    squares += step * (value - mean);
  }
};

}  // namespace

TrainingStatistics training_statistics(const MatrixF& values, std::size_t n_columns) {
  const auto n_cells = static_cast<std::size_t>(values.cols());
  check(n_columns > 0 && n_cells % n_columns == 0, "training_statistics: whole planes are needed");
  TrainingStatistics statistics;
  statistics.cell_mean.assign(n_cells, 0.0);
  std::vector<Spread> columns(n_columns);
  for (Eigen::Index i_case = 0; i_case < values.rows(); ++i_case)
    for (std::size_t cell = 0; cell < n_cells; ++cell) {
      const double value = values(i_case, static_cast<Eigen::Index>(cell));
      statistics.cell_mean[cell] += (value - statistics.cell_mean[cell]) / static_cast<double>(i_case + 1);
      columns[cell % n_columns].add(value);
    }
  statistics.column_sigma.reserve(n_columns);
  for (const auto& column : columns)
    statistics.column_sigma.push_back(column.n > 0 ? std::sqrt(column.squares / column.n) : 0.0);
  return statistics;
}

ErrorSums& ErrorSums::operator+=(const ErrorSums& other) {
  if (other.n == 0) return *this;
  const double both = static_cast<double>(n + other.n), step = other.truth_mean - truth_mean;
  truth_spread +=
      other.truth_spread + step * step * static_cast<double>(n) * static_cast<double>(other.n) / both;
  truth_mean += step * static_cast<double>(other.n) / both;
  n += other.n;
  error += other.error;
  departure += other.departure;
  n_standardised += other.n_standardised;
  standardised += other.standardised;
  return *this;
}

double ErrorSums::nrmse() const { return math::nrmse(error, departure); }
double ErrorSums::standardised_mse() const {
  return n_standardised > 0 ? standardised / static_cast<double>(n_standardised) : undefined;
}
double ErrorSums::rmse() const { return n > 0 ? std::sqrt(error / static_cast<double>(n)) : undefined; }
double ErrorSums::r2() const { return truth_spread > 0 ? 1 - error / truth_spread : undefined; }

ErrorSums error_sums(std::span<const float> truth, std::span<const float> prediction,
                     const TrainingStatistics& statistics, std::span<const std::size_t> part) {
  check(truth.size() == prediction.size() && truth.size() == statistics.cell_mean.size(),
        "error_sums: sizes differ");
  ErrorSums sums;
  Spread spread;
  const std::size_t n_columns = statistics.column_sigma.size();
  const auto score = [&](std::size_t cell) {
    const double y = truth[cell], difference = double{prediction[cell]} - y;
    sums.error += difference * difference;
    sums.departure += (statistics.cell_mean[cell] - y) * (statistics.cell_mean[cell] - y);
    spread.add(y);
    const double sigma = statistics.column_sigma[cell % n_columns];
    if (!(sigma > 0)) return;
    sums.standardised += difference * difference / (sigma * sigma);
    ++sums.n_standardised;
  };
  if (part.empty())
    for (std::size_t cell = 0; cell < truth.size(); ++cell) score(cell);
  else
    for (const std::size_t cell : part) score(cell);
  sums.n = static_cast<std::size_t>(spread.n);
  sums.truth_mean = spread.mean;
  sums.truth_spread = spread.squares;
  return sums;
}

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

double noise_energy(const MatrixF& runs) {
  check(runs.rows() >= 2, "noise_energy: two runs of the same boundary conditions are needed");
  const MatrixD values = runs.cast<double>();
  const Eigen::RowVectorXd mean = values.colwise().mean();
  return (values.rowwise() - mean).squaredNorm() / static_cast<double>(runs.rows() - 1);
}

std::vector<double> noise_at_loads(std::span<const double> measured_loads, std::span<const double> energies,
                                   std::span<const double> loads) {
  check(!energies.empty() && measured_loads.size() == energies.size(), "noise_at_loads: sizes differ");
  const auto n = static_cast<double>(energies.size());
  double mean = 0, x = 0, y = 0, xx = 0, xy = 0;
  bool positive = true;
  for (std::size_t i = 0; i < energies.size(); ++i) {
    mean += energies[i] / n;
    positive = positive && energies[i] > 0 && measured_loads[i] > 0;
    const double u = std::log(measured_loads[i]), v = std::log(energies[i]);
    x += u / n;
    y += v / n;
    xx += u * u / n;
    xy += u * v / n;
  }
  constexpr double same_load = 1e-6;  // variance of the logarithm of loads that do not differ
  const bool has_slope = positive && xx - x * x > same_load;
  const double exponent = has_slope ? (xy - x * y) / (xx - x * x) : 0;
  std::vector<double> result;
  for (const double load : loads)
    result.push_back(has_slope && load > 0 ? std::exp(y + exponent * (std::log(load) - x)) : mean);
  return result;
}

double nrmse_without_noise(const ErrorSums& sums, double noise) {
  return sums.error > noise ? math::nrmse(sums.error - noise, sums.departure - noise) : undefined;
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
