#include "elrom/particle/drag.hpp"

#include <algorithm>
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

double stokes(double diameter, const Gas& gas) { return 3 * std::numbers::pi * gas.viscosity * diameter; }

double wen_yu(double d, double speed, double voidage, const Gas& gas) {
  return stokes(d, gas) * over_stokes(voidage * reynolds_of(d, speed, gas)) * std::pow(voidage, -2.65);
}

double ergun(double d, double speed, double voidage, const Gas& gas) {
  const double volume = std::numbers::pi / 6 * d * d * d;
  return volume * (150 * (1 - voidage) * gas.viscosity / (voidage * d * d) + 1.75 * gas.density * speed / d);
}

double gidaspow(double d, double speed, double voidage, const Gas& gas) {
  const double share = 0.5 + std::atan(262.5 * (0.8 - voidage)) / std::numbers::pi;
  return (1 - share) * wen_yu(d, speed, voidage, gas) + share * ergun(d, speed, voidage, gas);
}

double syamlal(double d, double speed, double voidage, const Gas& gas) {
  const double a = std::pow(voidage, 4.14);
  const double b = voidage <= 0.85 ? 0.8 * std::pow(voidage, 1.28) : std::pow(voidage, 2.65);
  const double re = reynolds_of(d, speed, gas), half = 0.06 * re;
  const double ratio = 0.5 * (a - half + std::sqrt(half * half + 0.12 * re * (2 * b - a) + a * a));
  const double root = 0.63 * std::sqrt(re) + 4.8 * std::sqrt(ratio);  // of C_D Re
  return std::numbers::pi / 8 * d * gas.viscosity * voidage * root * root / (ratio * ratio);
}

void expect_falls(double diameter, double density, const Gas& gas, double gravity) {
  if (!(diameter > 0 && gas.density > 0 && gas.viscosity > 0 && gravity > 0 && density > gas.density))
    throw UsageError(Problem{.what = "no terminal speed",
                             .expected = "a sphere denser than the gas, and positive numbers"});
}

// Where a force that grows with speed carries a weight. @param high speed at which it certainly does
template <class Force>
double speed_that_carries(double weight, double high, const Force& force) {
  double low = 0;
  for (int i = 0; i < 200 && low < high; ++i) {
    const double middle = 0.5 * (low + high);
    (force(middle) < weight ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

}  // namespace

double schiller_naumann(double reynolds) { return 24 / reynolds * over_stokes(reynolds); }

double drag_rate(double diameter, double relative_speed, const Gas& gas) {
  return stokes(diameter, gas) * over_stokes(reynolds_of(diameter, relative_speed, gas));
}

double drag_rate(DragLaw law, double diameter, double speed, double voidage, const Gas& gas) {
  switch (law) {
    case DragLaw::stokes:
      return stokes(diameter, gas);
    case DragLaw::wen_yu:
      return wen_yu(diameter, speed, voidage, gas);
    case DragLaw::ergun:
      return ergun(diameter, speed, voidage, gas);
    case DragLaw::gidaspow:
      return gidaspow(diameter, speed, voidage, gas);
    case DragLaw::syamlal:
      return syamlal(diameter, speed, voidage, gas);
    case DragLaw::schiller_naumann:
      break;
  }
  return drag_rate(diameter, speed, gas);
}

double minimum_fluidisation_speed(DragLaw law, double diameter, double density, double voidage,
                                  const Gas& gas, double gravity) {
  expect_falls(diameter, density, gas, gravity);
  if (!needs_voidage(law) || !(voidage > 0 && voidage < 1))
    throw UsageError(Problem{.what = "no minimum fluidisation",
                             .expected = "a voidage between 0 and 1, and a law that knows it"});
  // beta u / eps_f^2 = eps_s (rho_p - rho) g at the superficial speed u, for each sphere.
  const double weight = sphere_mass(diameter, density - gas.density) * gravity;
  return speed_that_carries(weight, terminal_speed(diameter, density, gas, gravity), [&](double u) {
    return drag_rate(law, diameter, u / voidage, voidage, gas) * u / (voidage * voidage);
  });
}

double terminal_speed(double diameter, double density, const Gas& gas, double gravity) {
  expect_falls(diameter, density, gas, gravity);
  const double weight = sphere_mass(diameter, density - gas.density) * gravity;
  return speed_that_carries(weight, weight / stokes(diameter, gas),
                            [&](double u) { return drag_rate(diameter, u, gas) * u; });
}

}  // namespace elrom::particle
