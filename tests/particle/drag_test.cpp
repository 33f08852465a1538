#include "elrom/particle/drag.hpp"

#include <gmock/gmock.h>

#include <numbers>

#include "elrom/base/error.hpp"
#include "elrom/particle/pairs.hpp"

namespace elrom::particle {
namespace {

// particles.md 9: 315 and 475 um, 1000 kg/m3, in air.
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

}  // namespace
}  // namespace elrom::particle
