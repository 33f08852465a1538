#include "elrom/particle/drag.hpp"

#include <cmath>
#include <numbers>

#include "elrom/base/error.hpp"
#include "elrom/particle/pairs.hpp"

namespace elrom::particle {
namespace {

// C_D Re / 24, finite at rest.
double over_stokes(double reynolds) {
  if (reynolds < 1000) return 1 + 0.15 * std::pow(reynolds, 0.687);
  return 0.44 * reynolds / 24;
}

double reynolds_of(double diameter, double speed, const Gas& gas) {
  return gas.density * speed * diameter / gas.viscosity;
}

}  // namespace

double schiller_naumann(double reynolds) { return 24 / reynolds * over_stokes(reynolds); }

double drag_rate(double diameter, double relative_speed, const Gas& gas) {
  return 3 * std::numbers::pi * gas.viscosity * diameter *
         over_stokes(reynolds_of(diameter, relative_speed, gas));
}

double terminal_speed(double diameter, double density, const Gas& gas, double gravity) {
  if (!(diameter > 0 && gas.density > 0 && gas.viscosity > 0 && gravity > 0 && density > gas.density))
    throw UsageError(Problem{.what = "no terminal speed",
                             .expected = "a sphere denser than the gas, and positive numbers"});
  const double weight = sphere_mass(diameter, density - gas.density) * gravity;
  // Drag grows with speed, so the root lies between rest and Stokes's speed.
  double low = 0, high = weight / drag_rate(diameter, 0, gas);
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (drag_rate(diameter, middle, gas) * middle < weight ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace elrom::particle
