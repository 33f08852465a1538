#pragma once
// Statistics accumulated in double, stable for data of any offset and size.

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::math {

/// Mean and variance of a stream (Welford 1962), mergeable (Chan, Golub, LeVeque 1983, eq. 2.1).
class RunningMoments {
 public:
  void add(double value);
  void merge(const RunningMoments& other);
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] double mean() const { return mean_; }
  /// Population variance (divided by n); 0 for fewer than two values.
  [[nodiscard]] double variance() const;
  [[nodiscard]] double deviation() const;

 private:
  std::size_t count_ = 0;
  double mean_ = 0, squares_ = 0;
};

/// Sum with an error that grows with log n (pairwise).
[[nodiscard]] double sum(std::span<const double> values);

/// Linear interpolation between order statistics (type 7 of
/// Hyndman & Fan 1996), p in [0, 1]; NaN for no values.
[[nodiscard]] double quantile(std::vector<double> values, double p);
[[nodiscard]] double median(std::vector<double> values);
/// Median of absolute deviations from the median, times 1.4826: the standard deviation of a normal sample.
[[nodiscard]] double robust_deviation(const std::vector<double>& values);

/// The ceil((n + 1) level)-th smallest score; infinity when n scores cannot promise that level.
[[nodiscard]] double conformal_quantile(std::vector<double> scores, double level);

/// Sum of squares of all elements, in double.
[[nodiscard]] double sum_of_squares(const MatrixF& values);
/// sum (a - b)^2 in double; a and b of one size.
[[nodiscard]] double squared_distance(std::span<const float> a, std::span<const float> b);
/// The NRMSE of every report and comparison: sqrt(sum (p - y)^2 / sum (m - y)^2), y the truth, p the
/// prediction, m the mean of the training cases; 0 is perfect, 1 is no better than the mean.
/// @param undefined for a truth that does not depart from the mean
[[nodiscard]] double nrmse(double squared_error, double squared_departure,
                           double undefined = std::numeric_limits<double>::quiet_NaN());

struct ColumnMoments {
  Eigen::VectorXd mean, deviation;  //!< (n_columns); population deviation
};
/// Moments over the given rows of each column; two passes, in double.
[[nodiscard]] ColumnMoments column_moments(const MatrixF& values, std::span<const std::size_t> rows);
[[nodiscard]] ColumnMoments column_moments(const MatrixD& values);

/// 0, 1 ... n - 1: "all rows".
[[nodiscard]] std::vector<std::size_t> all_rows(std::size_t n);
/// The given rows as a matrix of their own.
[[nodiscard]] MatrixD take_rows(const MatrixD& values, std::span<const std::size_t> rows);

}  // namespace elrom::math
