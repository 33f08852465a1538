#include "elrom/particle/balance.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace elrom::particle {
namespace {

Scalars masses(const Scalars& diameter, const Scalars& density) {
  return sphere_mass(1, 1) * density * diameter.cube();
}

// m d^2 / 10 is a solid sphere's moment of inertia.
Scalars energy_of(const Scalars& mass, const Scalars& diameter, const Components& velocity,
                  const Components& spin) {
  return 0.5 * mass * (lengths(velocity).square() + 0.1 * (diameter * lengths(spin)).square());
}

}  // namespace

Scalars lengths(const Components& vectors) { return vectors.square().rowwise().sum().sqrt(); }

Scalars kinetic_energy(const Pairs& pairs, const Motion& motion) {
  return energy_of(masses(pairs.diameter_1, pairs.density_1), pairs.diameter_1, motion.velocity_1,
                   motion.spin_1) +
         energy_of(masses(pairs.diameter_2, pairs.density_2), pairs.diameter_2, motion.velocity_2,
                   motion.spin_2);
}

Scalars momentum_errors(const Pairs& pairs, const Motion& after) {
  const Scalars mass_1 = masses(pairs.diameter_1, pairs.density_1),
                mass_2 = masses(pairs.diameter_2, pairs.density_2);
  const Components change = (after.velocity_1 - pairs.before.velocity_1).colwise() * mass_1 +
                            (after.velocity_2 - pairs.before.velocity_2).colwise() * mass_2;
  const Scalars size = mass_1 * lengths(pairs.before.velocity_1) + mass_2 * lengths(pairs.before.velocity_2);
  return (size > 0).select(lengths(change) / size, 0.0);
}

Scalars energy_changes(const Pairs& pairs, const Motion& after) {
  const Scalars before = kinetic_energy(pairs, pairs.before);
  return (before > 0).select((kinetic_energy(pairs, after) - before) / before, 0.0);
}

Scalars angles_between(const Components& a, const Components& b) {
  Scalars result(a.rows());
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const Eigen::Vector3d u = a.row(i).matrix().transpose(), v = b.row(i).matrix().transpose();
    result[i] = std::atan2(u.cross(v).norm(), u.dot(v)) * 180 / std::numbers::pi;
  }
  return result;
}

Scalars impact_angles(const Pairs& pairs) {
  return angles_between(pairs.before.velocity_1 - pairs.before.velocity_2, pairs.normal);
}

}  // namespace elrom::particle
