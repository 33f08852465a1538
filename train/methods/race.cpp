#include "race.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/math/statistics.hpp"

namespace elrom::methods {

namespace {

/// What may still be is within so many standard errors of the cases. Cases of a fold share a model and tell
/// less than independent ones; but all bands of columns are taken at their most at once, which tells more.
constexpr double chance = 2;
constexpr Eigen::Index fewest_cases = 24;  ///< that a candidate is judged by

}  // namespace

std::vector<std::vector<std::size_t>> rounds_of(std::size_t n_folds) {
  std::vector<std::vector<std::size_t>> rounds(3);
  for (std::size_t k = 0; k < n_folds; ++k) rounds[k == n_folds / 2 ? 0 : k % 3 == 1 ? 1 : 2].push_back(k);
  std::erase_if(rounds, [](const auto& round) { return round.empty(); });
  return rounds;
}

bool may_gain(const Shown& shown, double full_gain) {
  const Eigen::Index n = shown.gains.rows();
  if (n < fewest_cases) return true;
  const auto count = static_cast<double>(n);
  double gain = 0;
  for (Eigen::Index band = 0; band < shown.departures.size(); ++band) {
    math::RunningMoments moments;
    for (const double of_case : shown.gains.col(band)) moments.add(of_case);
    const double most = count * moments.mean() + chance * std::sqrt(count) * moments.deviation();
    const double departed = shown.departures[band];
    if (!(most > negligible_weight * departed)) continue;
    const double weight = std::min(1.0, most / departed);
    gain += weight * (2 * most - weight * departed);
  }
  return gain > 2 * negligible_weight * full_gain * shown.squares;
}

}  // namespace elrom::methods
