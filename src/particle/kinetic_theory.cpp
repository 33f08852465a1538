#include "elrom/particle/kinetic_theory.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace elrom::particle {
namespace {

constexpr double nearest = 1e-3;          // of the fraction to the packing, where closures would be infinite
constexpr double least_invariant = 1e-4;  // 1/s2
constexpr double root_pi = 1.7724538509055159;

double below_packing(const GranularLaw& law, double fraction) {
  return std::clamp(fraction, 0.0, law.packing - nearest);
}

// d g0 / d fraction.
double radial_slope(const GranularLaw& law, double fraction) {
  constexpr double h = 1e-5;
  return (radial_distribution(law, fraction + h) - radial_distribution(law, std::max(0.0, fraction - h))) /
         (fraction + h - std::max(0.0, fraction - h));
}

// Closures over sqrt(T).
double viscosity_over_root(const GranularLaw& law, const Solids& s) {
  const double e1 = 1 + law.restitution, g0 = radial_distribution(law, s.fraction);
  const double scale = s.density * s.diameter, eps = s.fraction;
  const double collisions = 0.8 * eps * eps * scale * g0 * e1 / root_pi;
  if (law.viscosity == FlightViscosity::gidaspow) {
    const double bracket = 1 + 0.8 * e1 * eps * g0;
    return collisions + 10 * scale * root_pi / (96 * e1 * g0) * bracket * bracket;
  }
  const double bracket = 1 + 0.4 * e1 * (3 * law.restitution - 1) * eps * g0;
  return collisions + eps * scale * root_pi / (6 * (3 - law.restitution)) * bracket;
}
double bulk_over_root(const GranularLaw& law, const Solids& s) {
  return 4.0 / 3 * s.fraction * s.fraction * s.density * s.diameter * radial_distribution(law, s.fraction) *
         (1 + law.restitution) / root_pi;
}
double dissipation_over_cube(const GranularLaw& law, const Solids& s) {
  return 12 * (1 - law.restitution * law.restitution) * radial_distribution(law, s.fraction) * s.fraction *
         s.fraction * s.density / (s.diameter * root_pi);
}

}  // namespace

double radial_distribution(const GranularLaw& law, double fraction) {
  const double eps = below_packing(law, fraction);
  if (law.radial == RadialLaw::carnahan_starling) return (1 - 0.5 * eps) / std::pow(1 - eps, 3);
  return 1 / (1 - std::cbrt(eps / law.packing));
}

double granular_pressure(const GranularLaw& law, const Solids& s, double temperature) {
  return s.fraction * s.density * temperature *
         (1 + 2 * (1 + law.restitution) * s.fraction * radial_distribution(law, s.fraction));
}

double frictional_pressure(const GranularLaw& law, double fraction) {
  const double above = fraction - law.friction_from;
  if (above <= 0) return 0;
  return 0.1 * fraction * above * above / std::pow(std::max(law.packing - fraction, nearest), 5);
}

double pressure_slope(const GranularLaw& law, const Solids& s, double temperature) {
  const double eps = s.fraction, g0 = radial_distribution(law, eps);
  const double collisional = 2 * (1 + law.restitution) * eps * (2 * g0 + eps * radial_slope(law, eps));
  double slope = s.density * temperature * (1 + collisional);
  const double above = eps - law.friction_from, room = std::max(law.packing - eps, nearest);
  if (above > 0)
    slope +=
        0.1 * above / std::pow(room, 5) * (above + 2 * eps + (room > nearest ? 5 * eps * above / room : 0));
  return slope;
}

double granular_viscosity(const GranularLaw& law, const Solids& s, double temperature) {
  return viscosity_over_root(law, s) * std::sqrt(temperature);
}

double bulk_viscosity(const GranularLaw& law, const Solids& s, double temperature) {
  return bulk_over_root(law, s) * std::sqrt(temperature);
}

double frictional_viscosity(const GranularLaw& law, double fraction, const Strain& strain) {
  // Second invariant of the deviator: half of its double product with itself.
  const double deviator = strain.squared - strain.divergence * strain.divergence / 3;
  return frictional_pressure(law, fraction) * std::sin(law.friction_angle) /
         (2 * std::sqrt(std::max(0.5 * deviator, least_invariant)));
}

double dissipation(const GranularLaw& law, const Solids& s, double temperature) {
  return dissipation_over_cube(law, s) * temperature * std::sqrt(temperature);
}

double algebraic_temperature(const GranularLaw& law, const Solids& s, const Strain& strain,
                             double gas_exchange) {
  if (!(s.fraction > 0)) return 0;
  const double viscosity = viscosity_over_root(law, s), div = strain.divergence;
  const double sheared =
      2 * viscosity * strain.squared + (bulk_over_root(law, s) - 2.0 / 3 * viscosity) * div * div;
  // c T + b sqrt(T) = sheared
  const double b = granular_pressure(law, s, 1) * div + 3 * gas_exchange, c = dissipation_over_cube(law, s);
  if (sheared <= 0) return b < 0 ? b * b / (c * c) : 0;
  const double root = std::sqrt(b * b + 4 * c * sheared);
  const double speed = b > 0 ? 2 * sheared / (b + root) : (root - b) / (2 * c);
  return speed * speed;
}

}  // namespace elrom::particle
