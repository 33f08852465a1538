#include "elrom/study/scores.hpp"

#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::study {
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

// Runs of the same boundary conditions: each set holds one scored case and its repeats, or repeats alone.
std::vector<std::vector<std::size_t>> repeat_sets(const MatrixD& inputs, const std::vector<bool>& is_repeat) {
  std::vector<std::vector<std::size_t>> sets;
  std::vector<bool> taken(is_repeat.size(), false);
  for (std::size_t i = 0; i < is_repeat.size(); ++i) {
    if (taken[i]) continue;
    std::vector<std::size_t> set{i};
    bool any_repeat = is_repeat[i];
    for (std::size_t j = i + 1; j < is_repeat.size(); ++j) {
      const auto a = inputs.row(static_cast<Eigen::Index>(i)), b = inputs.row(static_cast<Eigen::Index>(j));
      if (taken[j] || !((a - b).cwiseAbs().array() <= 1e-9 * a.cwiseAbs().array()).all()) continue;
      taken[j] = true;
      any_repeat = any_repeat || is_repeat[j];
      set.push_back(j);
    }
    if (any_repeat && set.size() >= 2) sets.push_back(std::move(set));
  }
  return sets;
}

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

JudgedCases judged_cases(const field::SnapshotStore& store, const std::vector<std::size_t>& held_out) {
  JudgedCases cases;
  std::vector<bool> is_repeat;
  for (const auto row : held_out) {
    const auto& name = store.cases()[row].inputs.name;
    is_repeat.push_back(store.furnace() && store.furnace()->is_repeat(name));
    if (!is_repeat.back()) cases.scored.push_back(row);
  }
  for (const auto& set : repeat_sets(store.inputs(held_out), is_repeat)) {
    cases.repeats.emplace_back();
    for (const std::size_t i : set) cases.repeats.back().push_back(held_out[i]);
  }
  return cases;
}

}  // namespace elrom::study
