#include "elrom/particle/collision_summary.hpp"

#include <limits>
#include <vector>

#include "elrom/particle/balance.hpp"

namespace elrom::particle {
namespace {

Spread spread(const Eigen::Ref<const Scalars>& values) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (values.size() == 0) return {none, none, none};
  return {values.minCoeff(), values.mean(), values.maxCoeff()};
}

Scalars joined(const Scalars& a, const Scalars& b) {
  Scalars both(a.size() + b.size());
  both << a, b;
  return both;
}

Scalars speeds(const Motion& motion) {
  return joined(lengths(motion.velocity_1), lengths(motion.velocity_2));
}

Scalars surface_speeds(const Pairs& pairs, const Motion& motion) {
  return joined(0.5 * pairs.diameter_1 * lengths(motion.spin_1),
                0.5 * pairs.diameter_2 * lengths(motion.spin_2));
}

void count_kinds(const Pairs& pairs, const Scalars& impact_angle, CollisionSummary& summary) {
  const auto apart = angles_between(pairs.before.velocity_1, pairs.before.velocity_2);
  for (Eigen::Index i = 0; i < apart.size(); ++i) {
    if (impact_angle[i] > CollisionSummary::grazing_from)
      ++summary.grazing;
    else if (apart[i] >= CollisionSummary::head_on_from)
      ++summary.head_on;
    else if (apart[i] <= CollisionSummary::catching_up_to)
      ++summary.catching_up;
    else
      ++summary.crossing;
  }
}

std::size_t n_capped(const CollisionSet& set) {
  if (!set.speed_cap) return 0;
  const double cap = *set.speed_cap * (1 - 1e-12);  // cutting rounds
  const auto& after = set.parting.after;
  return static_cast<std::size_t>(
      (lengths(after.velocity_1) >= cap || lengths(after.velocity_2) >= cap).count());
}

/// Of the pairs that touched.
Scalars durations(const Scalars& all) {
  std::vector<double> some;
  for (const double value : all)
    if (value > 0) some.push_back(value);
  return Eigen::Map<const Scalars>(some.data(), static_cast<Eigen::Index>(some.size()));
}

}  // namespace

CollisionSummary summarise(const CollisionSet& set) {
  const auto& pairs = set.pairs;
  const auto& parting = set.parting;
  const Components relative = pairs.before.velocity_1 - pairs.before.velocity_2;
  const auto impact_angle = impact_angles(pairs);
  const double energy = kinetic_energy(pairs, pairs.before).sum();
  const auto touched = durations(parting.duration);
  CollisionSummary summary{.n_pairs = set.size(),
                           .speed = spread(speeds(pairs.before)),
                           .speed_after = spread(speeds(parting.after)),
                           .relative_speed = spread(lengths(relative)),
                           .impact_angle = spread(impact_angle),
                           .diameter_1 = spread(pairs.diameter_1),
                           .diameter_2 = spread(pairs.diameter_2),
                           .overlap_share = spread(parting.overlap / pairs.diameter_1.min(pairs.diameter_2)),
                           .duration = spread(touched),
                           .surface_speed = spread(surface_speeds(pairs, pairs.before)),
                           .surface_speed_after = spread(surface_speeds(pairs, parting.after)),
                           .momentum_error = momentum_errors(pairs, parting.after).maxCoeff(),
                           .started_overlapped = static_cast<std::size_t>((pairs.overlap > 0).count()),
                           .capped = n_capped(set),
                           .stayed = parting.n_stayed,
                           .never_met = set.size() - static_cast<std::size_t>(touched.size())};
  if (energy > 0) summary.energy_lost = 1 - kinetic_energy(pairs, parting.after).sum() / energy;
  count_kinds(pairs, impact_angle, summary);
  return summary;
}

}  // namespace elrom::particle
