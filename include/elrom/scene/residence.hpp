#pragma once
// How long the spheres of a group stayed in the domain before they left: counts in bins that are even on a
// logarithmic scale, so that they take the same room for a jet's milliseconds and a furnace's minutes.
//
// Thread rule: plain data.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace elrom::scene {

struct ResidenceTimes {
  static constexpr double shortest = 1e-6;  ///< s, where the first bin begins
  static constexpr int bins_per_decade = 20;
  static constexpr std::size_t n_bins = 12 * bins_per_decade;  ///< up to 1e6 s

  std::vector<std::int64_t> counts = std::vector<std::int64_t>(n_bins);
  double sum = 0;  ///< s

  /// What lies beyond the bins is counted in the outer ones.
  void add(double seconds);
  [[nodiscard]] std::int64_t number() const;
  [[nodiscard]] double mean() const;  ///< s; NaN for none
  /// Time that a share of them stayed no longer than, s, to half a bin (6 %); NaN for none.
  /// @param share 0 ... 1
  [[nodiscard]] double quantile(double share) const;
  /// Where a bin begins, s. @param bin 0 ... n_bins
  [[nodiscard]] static double edge(std::size_t bin);
};

}  // namespace elrom::scene
