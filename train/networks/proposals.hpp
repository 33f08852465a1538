#pragma once
// The algorithms that propose points of the unit cube. Internal to the search.

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "elrom/base/random.hpp"

namespace elrom::networks {

/// What an algorithm asks about a point: a finite value to be made small.
using Ask = std::function<double(std::span<const double> point)>;

/// Thrown by Ask when all trials are spent; ends the algorithm.
struct SearchEnded {};

/// Runs `algorithm` until Ask throws or the algorithm gives up; whatever Ask throws, but SearchEnded, is
/// thrown again.
/// @param n_trials distinct trials to plan with @param initial_step (n_dimensions) of local algorithms
/// @throws UsageError for an unknown algorithm
void propose(const std::string& algorithm, std::size_t n_dimensions, const std::vector<double>& initial_step,
             std::size_t n_trials, base::Seed seed, const Ask& ask);

/// Point i of the Sobol sequence (Joe & Kuo 2008), shifted at random; at most 6 dimensions.
[[nodiscard]] std::vector<double> sobol_point(std::size_t i, std::span<const double> shift);

}  // namespace elrom::networks
