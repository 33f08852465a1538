#pragma once
// How far a collision model is from the pairs of a set, and what it does to momentum and energy.

#include <array>
#include <string>
#include <vector>

#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/collision_set.hpp"

namespace elrom::particle {

/// Of the pairs first to first + count of a set.
struct CollisionErrors {
  /// A pair counts as given energy from this share of its own on: less is rounding.
  static constexpr double gain_from = 1e-12;

  std::size_t n_pairs = 0;
  std::array<double, 3> mae{};  ///< of u, v, w of both spheres, m/s
  double mae_velocity = 0;      ///< mean of the three
  double mae_surface = 0;       ///< of r w, components of both spheres, m/s
  double greatest = 0;          ///< |error| of a velocity component, m/s
  /// |error of the velocity| / |velocity after|, of all spheres: 10, 50, 90, 99 %.
  std::array<double, 4> relative{};
  double momentum_error = 0;       ///< greatest |change| / (|p1| + |p2|) of a pair
  double mean_momentum_error = 0;  ///< mean of the same
  double energy_gain = 0;    ///< greatest (energy after - before) / before of a pair by the model; at least 0
  double gaining_share = 0;  ///< of pairs that the model gives energy
  double energy_lost = 0;    ///< share of the energy of all pairs: by the model
  double energy_lost_truth = 0;  ///< by the set
};

/// What the model makes of each pair.
[[nodiscard]] Motion motion_after(const CollisionModel& model, const Pairs& pairs);
/// |error of the velocity| / |velocity after| of all spheres, those of number 1 first; without those
/// that rest afterwards.
[[nodiscard]] std::vector<double> relative_errors(const Motion& model, const Motion& truth);
/// @param count at least one pair
[[nodiscard]] CollisionErrors errors_of(const CollisionModel& model, const CollisionSet& set,
                                        std::size_t first, std::size_t count);
/// Processor time of one pair, s: these pairs block by block
/// until n_calls are done, the quickest of five such runs.
[[nodiscard]] double seconds_a_call(const CollisionModel& model, const Pairs& pairs, std::size_t n_calls);
/// {"mae_m_per_s": [u, v, w], ...}
[[nodiscard]] std::string to_json(const CollisionErrors& errors);

}  // namespace elrom::particle
