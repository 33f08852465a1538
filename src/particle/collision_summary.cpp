#include "elrom/particle/collision_summary.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

namespace elrom::particle {
namespace {

Spread spread(const Eigen::Ref<const Scalars>& values) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (values.size() == 0) return {none, none, none};
  return {values.minCoeff(), values.mean(), values.maxCoeff()};
}

Scalars lengths(const Components& vectors) { return vectors.square().rowwise().sum().sqrt(); }

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

/// Of each pair, degrees; 0 where a vector is none.
Scalars angles(const Components& a, const Components& b) {
  Scalars result(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const Eigen::Vector3d u = a.row(i).matrix().transpose(), v = b.row(i).matrix().transpose();
    result[i] = std::atan2(u.cross(v).norm(), u.dot(v)) * 180 / std::numbers::pi;
  }
  return result;
}

struct Masses {
  explicit Masses(const Pairs& pairs) : one(pairs.size()), two(pairs.size()) {
    for (Eigen::Index i = 0; i < one.size(); ++i) {
      one[i] = sphere_mass(pairs.diameter_1[i], pairs.density_1[i]);
      two[i] = sphere_mass(pairs.diameter_2[i], pairs.density_2[i]);
    }
  }
  Scalars one, two;
};

/// Of all pairs, J; m d^2 / 10 is a solid sphere's moment of inertia.
double kinetic_energy(const Pairs& pairs, const Masses& mass, const Motion& motion) {
  const auto of = [](const Scalars& m, const Scalars& d, const Components& v, const Components& w) {
    return (0.5 * m * (lengths(v).square() + 0.1 * (d * lengths(w)).square())).sum();
  };
  return of(mass.one, pairs.diameter_1, motion.velocity_1, motion.spin_1) +
         of(mass.two, pairs.diameter_2, motion.velocity_2, motion.spin_2);
}

double momentum_error(const CollisionSet& set, const Masses& mass) {
  const auto& before = set.pairs.before;
  const auto& after = set.parting.after;
  const Components change = (after.velocity_1 - before.velocity_1).colwise() * mass.one +
                            (after.velocity_2 - before.velocity_2).colwise() * mass.two;
  const Scalars size = mass.one * lengths(before.velocity_1) + mass.two * lengths(before.velocity_2);
  return (size > 0).select(lengths(change) / size, 0.0).maxCoeff();
}

void count_kinds(const Pairs& pairs, const Scalars& impact_angle, CollisionSummary& summary) {
  const auto apart = angles(pairs.before.velocity_1, pairs.before.velocity_2);
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
  const Masses mass(pairs);
  const Components relative = pairs.before.velocity_1 - pairs.before.velocity_2;
  const auto impact_angle = angles(relative, pairs.normal);
  const double energy = kinetic_energy(pairs, mass, pairs.before);
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
                           .momentum_error = momentum_error(set, mass),
                           .started_overlapped = static_cast<std::size_t>((pairs.overlap > 0).count()),
                           .capped = n_capped(set),
                           .stayed = parting.n_stayed,
                           .never_met = set.size() - static_cast<std::size_t>(touched.size())};
  if (energy > 0) summary.energy_lost = 1 - kinetic_energy(pairs, mass, parting.after) / energy;
  count_kinds(pairs, impact_angle, summary);
  return summary;
}

}  // namespace elrom::particle
