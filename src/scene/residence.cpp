#include "elrom/scene/residence.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace elrom::scene {

void ResidenceTimes::add(double seconds) {
  const double bin = bins_per_decade * std::log10(std::max(seconds, shortest) / shortest);
  ++counts[static_cast<std::size_t>(std::min(std::floor(bin), static_cast<double>(n_bins - 1)))];
  sum += seconds;
}

std::int64_t ResidenceTimes::number() const {
  std::int64_t n = 0;
  for (const auto count : counts) n += count;
  return n;
}

double ResidenceTimes::mean() const {
  const auto n = number();
  return n > 0 ? sum / static_cast<double>(n) : std::numeric_limits<double>::quiet_NaN();
}

double ResidenceTimes::quantile(double share) const {
  double wanted = share * static_cast<double>(number());
  for (std::size_t bin = 0; bin < n_bins; ++bin) {
    const auto count = static_cast<double>(counts[bin]);
    if (count > 0 && wanted <= count) return edge(bin) * std::pow(edge(1) / edge(0), wanted / count);
    wanted -= count;
  }
  return std::numeric_limits<double>::quiet_NaN();
}

double ResidenceTimes::edge(std::size_t bin) {
  return shortest * std::pow(10.0, static_cast<double>(bin) / bins_per_decade);
}

}  // namespace elrom::scene
