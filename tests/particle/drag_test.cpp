#include "elrom/particle/drag.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "elrom/base/error.hpp"
#include "elrom/particle/pairs.hpp"

namespace elrom::particle {
namespace {

// Published: 315 and 475 um, 1000 kg/m3, in air.
TEST(Drag, GivesThePublishedTerminalSpeeds) {
  EXPECT_NEAR(terminal_speed(315e-6, 1000, {}), 1.237, 5e-4);
  EXPECT_NEAR(terminal_speed(475e-6, 1000, {}), 1.926, 5e-4);
}

TEST(Drag, CarriesTheWeightAtTheTerminalSpeed) {
  for (const double diameter : {1e-6, 1e-4, 1e-2}) {
    const double speed = terminal_speed(diameter, 2500, {});
    EXPECT_NEAR(drag_rate(diameter, speed, {}) * speed / (sphere_mass(diameter, 2500 - Gas{}.density) * 9.81),
                1, 1e-12);
  }
}

// C_D at Re 1: 24 * 1.15; at 1000 and beyond: Newton's 0.44.
TEST(Drag, HasTheCoefficientsOfSchillerAndNaumann) {
  EXPECT_NEAR(schiller_naumann(1), 27.6, 1e-12);
  EXPECT_NEAR(schiller_naumann(100), 24.0 / 100 * (1 + 0.15 * 23.6592), 1e-4);
  EXPECT_NEAR(schiller_naumann(5000), 0.44, 1e-12);
}

TEST(Drag, IsStokesAtRest) {
  EXPECT_DOUBLE_EQ(drag_rate(1e-4, 0, {1.2, 1.8e-5}), 3 * std::numbers::pi * 1.8e-5 * 1e-4);
}

TEST(Drag, RefusesASphereThatRises) { EXPECT_THROW((void)terminal_speed(1e-3, 1, {}), UsageError); }

// Ergun's own equation, in the superficial speed: 150 mu eps_s^2 U / (eps^3 d^2) + 1.75 rho eps_s U^2 /
// (eps^3 d).
TEST(Drag, OfAPackedBedDropsThePressureByErgunsEquation) {
  const Gas gas;
  const double d = 475e-6, eps = 0.4, volume = std::numbers::pi / 6 * d * d * d;
  for (const double u : {0.01, 0.3, 5.0}) {
    const double beta = (1 - eps) / volume * drag_rate(DragLaw::ergun, d, u / eps, eps, gas);
    const double drop = beta * (u / eps) / eps;
    const double ergun =
        150 * gas.viscosity * 0.36 * u / (0.064 * d * d) + 1.75 * gas.density * 0.6 * u * u / (0.064 * d);
    EXPECT_NEAR(drop, ergun, 1e-12 * ergun);
    const double gidaspow = drag_rate(DragLaw::gidaspow, d, u / eps, eps, gas);
    EXPECT_NEAR(gidaspow / drag_rate(DragLaw::ergun, d, u / eps, eps, gas), 1, 0.01);
  }
}

// Published: minimum fluidisation at a voidage of 0.4 by Ergun's equation, air.
TEST(Drag, FluidisesAtThePublishedSpeeds) {
  EXPECT_NEAR(minimum_fluidisation_speed(DragLaw::ergun, 315e-6, 1000, 0.4, {}), 0.0370, 5e-5);
  EXPECT_NEAR(minimum_fluidisation_speed(DragLaw::ergun, 475e-6, 1000, 0.4, {}), 0.0815, 5e-5);
  for (const auto& [voidage, speed] : {std::pair{0.40, 0.205}, {0.42, 0.236}, {0.44, 0.271}})
    EXPECT_NEAR(minimum_fluidisation_speed(DragLaw::ergun, 870e-6, 860, voidage, {1.2, 1.8e-5}), speed, 1e-3);
  EXPECT_THROW((void)minimum_fluidisation_speed(DragLaw::stokes, 1e-3, 1000, 0.4, {}), UsageError);
}

TEST(Drag, OfASphereAloneIsThatOfSchillerAndNaumann) {
  for (const double speed : {0.0, 0.1, 10.0}) {
    const double alone = drag_rate(1e-3, speed, {});
    EXPECT_NEAR(drag_rate(DragLaw::wen_yu, 1e-3, speed, 1, {}), alone, 1e-12 * alone);
    EXPECT_NEAR(drag_rate(DragLaw::gidaspow, 1e-3, speed, 1, {}), alone, 0.03 * alone);
    // Dalla Valle's coefficient is another fit: up to 31 % more near Re 600.
    EXPECT_NEAR(drag_rate(DragLaw::syamlal, 1e-3, speed, 1, {}), alone, 0.35 * alone);
  }
  EXPECT_NEAR(drag_rate(DragLaw::syamlal, 1e-3, 0, 1, {}) / drag_rate(1e-3, 0, {}), 4.8 * 4.8 / 24, 1e-12);
}

// Syamlal's law comes from Richardson & Zaki's terminal speeds of swarms: v_r = eps^4.14 where inertia is
// none.
TEST(Drag, OfASwarmFollowsItsTerminalSpeed) {
  const double crowd = drag_rate(DragLaw::syamlal, 1e-5, 1e-9, 0.7, {}),
               alone = drag_rate(DragLaw::syamlal, 1e-5, 1e-9, 1, {});
  EXPECT_NEAR(crowd / alone, 0.7 / std::pow(0.7, 4.14), 1e-3 * crowd / alone);
}

}  // namespace
}  // namespace elrom::particle
