#pragma once
// Statistics that a few wrong cases do not spoil.

#include <cstddef>
#include <vector>

#include "case_features.hpp"
#include "elrom/ingest/case_summary.hpp"

namespace elrom::ingest {

/// The value below which `share` of the values lie (nearest rank); NaN for none.
[[nodiscard]] double quantile(std::vector<double> values, double share);
[[nodiscard]] inline double median(std::vector<double> values) { return quantile(std::move(values), 0.5); }

struct RobustLine {
  double at_zero = 0, slope = 0;
  double scatter = 0;  //!< 90th percentile of the absolute residuals
  bool known = false;  //!< false with fewer finite points than asked for
  [[nodiscard]] double at(double x) const { return at_zero + slope * x; }
};

/// The median of the slopes between pairs of points, and the median of what is left (Theil 1950, Sen 1968).
/// Points with a NaN are left out. Of more than `most_pairs` pairs an even selection is used.
[[nodiscard]] RobustLine robust_line(const std::vector<double>& x, const std::vector<double>& y,
                                     std::size_t fewest_points, std::size_t most_pairs = 100000);

/// Logarithm of each case's load relative to the middle case: the median over what grows with the load.
class LoadProxy {
 public:
  /// @param rows features of every case, (n_cases)(n_features)
  LoadProxy(const CaseFeatures& features, const std::vector<std::vector<double>>& rows);
  [[nodiscard]] double of(const std::vector<double>& row) const;

 private:
  std::vector<std::size_t> features_;
  std::vector<double> middle_;  //!< of each of features_
};

}  // namespace elrom::ingest
