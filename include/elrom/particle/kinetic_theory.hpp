#pragma once
// Stress of many spheres as a continuum: kinetic theory of granular flow and friction where they are packed.
//
//   sigma = -p I + mu (grad u + grad u^T) + (lambda - 2/3 mu) div u I
//
// Radial distribution: Lun's 1/(1 - (eps/eps_max)^(1/3)) or Carnahan & Starling's
// (1 - eps/2)/(1 - eps)^3. Pressure eps rho T (1 + 2 (1+e) eps g0). Viscosity: collisions' 4/5 eps^2 rho d g0
// (1+e) sqrt(T/pi), and flight's by Gidaspow (1994) or Syamlal et al. (1993). Friction: Johnson & Jackson's
// (1987) pressure 0.1 eps (eps - eps_min)^2 / (eps_max - eps)^5 and Schaeffer's (1987) viscosity.
// T is the granular temperature, m2/s2, a third of the mean square of the velocities about their mean.
//
// Thread rule: pure functions.

#include "elrom/base/enum_names.hpp"

namespace elrom::particle {

enum class RadialLaw { lun, carnahan_starling };
inline constexpr base::EnumNames<RadialLaw, 2> radial_names{
    "radial distribution", {{RadialLaw::lun, "lun"}, {RadialLaw::carnahan_starling, "carnahan_starling"}}};
enum class FlightViscosity { gidaspow, syamlal };
inline constexpr base::EnumNames<FlightViscosity, 2> flight_viscosity_names{
    "viscosity", {{FlightViscosity::gidaspow, "gidaspow"}, {FlightViscosity::syamlal, "syamlal"}}};

struct GranularLaw {
  double restitution = 0.9;
  double packing = 0.63;        ///< eps_max
  double friction_from = 0.61;  ///< eps_min
  double friction_angle = 0.5;  ///< rad, of Schaeffer's viscosity
  bool damping = true;          ///< whether collisions even out velocities within a cell
  RadialLaw radial = RadialLaw::lun;
  FlightViscosity viscosity = FlightViscosity::gidaspow;
};

/// Of spheres at some place.
struct Solids {
  double fraction;  ///< eps, of space
  double density;   ///< of the material, kg/m3
  double diameter;  ///< m
};

/// How the mean velocity changes from place to place.
struct Strain {
  double divergence = 0;  ///< 1/s
  /// D:D of the symmetric gradient D = (grad u + grad u^T)/2, 1/s2
  double squared = 0;
};

/// g0; finite at the packing too.
[[nodiscard]] double radial_distribution(const GranularLaw& law, double fraction);
/// Pa. @param temperature m2/s2
[[nodiscard]] double granular_pressure(const GranularLaw& law, const Solids& solids, double temperature);
/// Pa; 0 below friction_from. Finite at the packing and above.
[[nodiscard]] double frictional_pressure(const GranularLaw& law, double fraction);
/// d (granular + frictional pressure) / d fraction at a constant temperature, Pa.
[[nodiscard]] double pressure_slope(const GranularLaw& law, const Solids& solids, double temperature);
/// Shear viscosity without friction, Pa s.
[[nodiscard]] double granular_viscosity(const GranularLaw& law, const Solids& solids, double temperature);
[[nodiscard]] double bulk_viscosity(const GranularLaw& law, const Solids& solids, double temperature);
/// p_fric sin(angle) / (2 sqrt(I_2D)), Pa s; I_2D is never taken below (1e-2 / s)^2.
[[nodiscard]] double frictional_viscosity(const GranularLaw& law, double fraction, const Strain& strain);
/// 12 (1-e^2) g0 eps^2 rho T^1.5 / (d sqrt(pi)), W/m3.
[[nodiscard]] double dissipation(const GranularLaw& law, const Solids& solids, double temperature);

/// Where production (-p I + tau) : grad u equals dissipation and 3 K T that the gas takes: in sqrt(T) a
/// quadratic equation, whose root above 0 this is. @param gas_exchange K, drag over relative speed in a
/// volume, kg/(m3 s)
[[nodiscard]] double algebraic_temperature(const GranularLaw& law, const Solids& solids, const Strain& strain,
                                           double gas_exchange = 0);

}  // namespace elrom::particle
