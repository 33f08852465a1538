#include "elrom/math/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "elrom/base/error.hpp"

namespace elrom::math {

void RunningMoments::add(double value) {
  ++count_;
  const double step = value - mean_;
  mean_ += step / static_cast<double>(count_);
  squares_ += step * (value - mean_);
}

void RunningMoments::merge(const RunningMoments& other) {
  if (other.count_ == 0) return;
  const double n_a = static_cast<double>(count_), n_b = static_cast<double>(other.count_), n = n_a + n_b;
  const double step = other.mean_ - mean_;
  mean_ += step * n_b / n;
  squares_ += other.squares_ + step * step * n_a * n_b / n;
  count_ += other.count_;
}

double RunningMoments::variance() const { return count_ < 2 ? 0 : squares_ / static_cast<double>(count_); }
double RunningMoments::deviation() const { return std::sqrt(variance()); }

double sum(std::span<const double> values) {
  constexpr std::size_t leaf = 32;
  if (values.size() <= leaf) return std::accumulate(values.begin(), values.end(), 0.0);
  const std::size_t half = values.size() / 2;
  return sum(values.first(half)) + sum(values.subspan(half));
}

double quantile(std::vector<double> values, double p) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::sort(values.begin(), values.end());
  const double place = std::clamp(p, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::size_t>(place);
  if (low + 1 == values.size()) return values.back();
  const double part = place - static_cast<double>(low);
  return part == 0 ? values[low] : values[low] + part * (values[low + 1] - values[low]);
}

double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

double robust_deviation(const std::vector<double>& values) {
  const double centre = median(values);
  std::vector<double> distance(values.size());
  std::transform(values.begin(), values.end(), distance.begin(),
                 [&](double v) { return std::abs(v - centre); });
  return 1.4826 * median(std::move(distance));
}

double conformal_quantile(std::vector<double> scores, double level) {
  // The small number keeps (n + 1) * level = 9.000000000000002 from asking for one score more.
  const double rank = std::ceil(static_cast<double>(scores.size() + 1) * level - 1e-9);
  if (rank > static_cast<double>(scores.size())) return std::numeric_limits<double>::infinity();
  const auto i = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  if (scores.empty()) return std::numeric_limits<double>::infinity();
  std::nth_element(scores.begin(), scores.begin() + static_cast<std::ptrdiff_t>(i), scores.end());
  return scores[i];
}

double sum_of_squares(const MatrixF& values) {
  double sum = 0;
  for (Eigen::Index i = 0; i < values.rows(); ++i) sum += values.row(i).cast<double>().squaredNorm();
  return sum;
}

double squared_distance(std::span<const float> a, std::span<const float> b) {
  check(a.size() == b.size(), "squared_distance: sizes differ");
  const auto n = static_cast<Eigen::Index>(a.size());
  const ConstMapF left(a.data(), 1, n), right(b.data(), 1, n);
  return (left.cast<double>() - right.cast<double>()).squaredNorm();
}

double nrmse(double squared_error, double squared_departure, double undefined) {
  return squared_departure > 0 ? std::sqrt(squared_error / squared_departure) : undefined;
}

namespace {

template <class Matrix>
ColumnMoments moments_of(const Matrix& values, std::span<const std::size_t> rows) {
  ColumnMoments moments{Eigen::VectorXd::Zero(values.cols()), Eigen::VectorXd::Zero(values.cols())};
  if (rows.empty()) return moments;
  for (std::size_t i : rows)
    moments.mean += values.row(static_cast<Eigen::Index>(i)).transpose().template cast<double>();
  moments.mean /= static_cast<double>(rows.size());
  for (std::size_t i : rows) {
    moments.deviation.array() +=
        (values.row(static_cast<Eigen::Index>(i)).transpose().template cast<double>() - moments.mean)
            .array()
            .square();
  }
  moments.deviation = (moments.deviation / static_cast<double>(rows.size())).cwiseSqrt();
  return moments;
}

}  // namespace

ColumnMoments column_moments(const MatrixF& values, std::span<const std::size_t> rows) {
  return moments_of(values, rows);
}

ColumnMoments column_moments(const MatrixD& values) {
  return moments_of(values, all_rows(static_cast<std::size_t>(values.rows())));
}

std::vector<std::size_t> all_rows(std::size_t n) {
  std::vector<std::size_t> rows(n);
  std::iota(rows.begin(), rows.end(), std::size_t{0});
  return rows;
}

MatrixD take_rows(const MatrixD& values, std::span<const std::size_t> rows) {
  MatrixD taken(static_cast<Eigen::Index>(rows.size()), values.cols());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    taken.row(static_cast<Eigen::Index>(i)) = values.row(static_cast<Eigen::Index>(rows[i]));
  }
  return taken;
}

}  // namespace elrom::math
