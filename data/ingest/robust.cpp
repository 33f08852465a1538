#include "robust.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace elrom::ingest {

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size() - 1) + 0.5);
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(at), values.end());
  return values[at];
}

RobustLine robust_line(const std::vector<double>& x, const std::vector<double>& y, std::size_t fewest_points,
                       std::size_t most_pairs) {
  std::vector<std::size_t> use;
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (std::isfinite(y[i]) && std::isfinite(x[i])) use.push_back(i);
  }
  if (use.size() < fewest_points) return {};
  std::vector<double> slopes;
  const std::size_t n_pairs = use.size() * (use.size() - 1) / 2;
  const std::size_t stride = std::max<std::size_t>(1, n_pairs / most_pairs);
  std::size_t count = 0;
  for (std::size_t a = 0; a < use.size(); ++a) {
    for (std::size_t b = a + 1; b < use.size(); ++b) {
      if (count++ % stride != 0) continue;
      const double run = x[use[b]] - x[use[a]];
      if (std::abs(run) > 1e-6) slopes.push_back((y[use[b]] - y[use[a]]) / run);
    }
  }
  RobustLine line{.known = true};
  line.slope = slopes.empty() ? 0 : median(std::move(slopes));
  std::vector<double> rest;
  for (const auto i : use) rest.push_back(y[i] - line.slope * x[i]);
  line.at_zero = median(rest);
  for (auto& value : rest) value = std::abs(value - line.at_zero);
  line.scatter = quantile(std::move(rest), 0.9);
  return line;
}

LoadProxy::LoadProxy(const CaseFeatures& features, const std::vector<std::vector<double>>& rows)
    : features_(features.load_features()) {
  for (const auto k : features_) {
    std::vector<double> values;
    for (const auto& row : rows) {
      if (std::isfinite(row[k])) values.push_back(row[k]);
    }
    middle_.push_back(median(std::move(values)));
  }
}

double LoadProxy::of(const std::vector<double>& row) const {
  std::vector<double> deviations;
  for (std::size_t i = 0; i < features_.size(); ++i) {
    const double deviation = row[features_[i]] - middle_[i];
    if (std::isfinite(deviation)) deviations.push_back(deviation);
  }
  return deviations.empty() ? 0 : median(std::move(deviations));
}

}  // namespace elrom::ingest
