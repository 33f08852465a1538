#pragma once
// Pairs of spheres as they touch, and as they part: one array a component, so that work runs across pairs.
//
// Sphere 1 and sphere 2 of a pair touch where the normal points, from the centre of 1 to that of 2.
// Everything is in SI: m, kg/m3, m/s, rad/s. Spheres are solid: moment of inertia 2/5 m r^2.

#include <Eigen/Core>
#include <cstddef>

namespace elrom::particle {

/// (n, 3): column 0 holds x of all pairs, then y, then z.
using Components = Eigen::Array<double, Eigen::Dynamic, 3>;
using Scalars = Eigen::ArrayXd;  ///< (n)

/// What moves: of each pair, before a collision or after it.
struct Motion {
  Motion() = default;
  explicit Motion(std::size_t n);
  Components velocity_1, velocity_2;  ///< m/s
  Components spin_1, spin_2;          ///< rad/s
};

struct Pairs {
  Pairs() = default;
  /// All values are zero. @param n pairs
  explicit Pairs(std::size_t n);

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(diameter_1.size()); }

  Motion before;
  Components normal;               ///< unit vectors, from 1 to 2
  Scalars diameter_1, diameter_2;  ///< m
  Scalars density_1, density_2;    ///< kg/m3
  Scalars overlap;                 ///< m, at the start; 0: the spheres just touch
};

/// Mass of a sphere, kg: pi/6 rho d^3.
[[nodiscard]] inline double sphere_mass(double diameter, double density) {
  return 0.52359877559829887 * density * diameter * diameter * diameter;
}

/// The pairs first to first + count.
[[nodiscard]] Motion slice(const Motion& motion, std::size_t first, std::size_t count);
[[nodiscard]] Pairs slice(const Pairs& pairs, std::size_t first, std::size_t count);

}  // namespace elrom::particle
