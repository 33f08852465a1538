#pragma once
// Drag of a gas on a single sphere.
//
// Thread rule: pure functions.

namespace elrom::particle {

struct Gas {
  double density = 1.184;      ///< kg/m3; air at 25 degC
  double viscosity = 1.84e-5;  ///< Pa s
};

/// Drag coefficient: 24/Re (1 + 0.15 Re^0.687) below Re = 1000, 0.44 above
/// (Schiller & Naumann 1933).
[[nodiscard]] double schiller_naumann(double reynolds);

/// Drag over the gas's speed relative to a sphere, kg/s: 1/8 pi d^2 rho C_D |u|. In the limit of a resting
/// gas Stokes's 3 pi mu d.
[[nodiscard]] double drag_rate(double diameter, double relative_speed, const Gas& gas);

/// Speed at which drag carries weight less buoyancy, m/s. @throws UsageError unless sizes and densities are
/// positive and the sphere is the denser one
[[nodiscard]] double terminal_speed(double diameter, double density, const Gas& gas, double gravity = 9.81);

}  // namespace elrom::particle
