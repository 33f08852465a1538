// Closures against hand values, limits and the balance that they solve.
#include "elrom/particle/kinetic_theory.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace elrom::particle {
namespace {

constexpr Solids medium{0.3, 1000, 315e-6};

TEST(KineticTheory, RadialDistributionsOfHandValues) {
  GranularLaw law;
  EXPECT_NEAR(radial_distribution(law, 0.63 / 8), 2, 1e-12);
  law.radial = RadialLaw::carnahan_starling;
  EXPECT_NEAR(radial_distribution(law, 0.5), 0.75 / 0.125, 1e-12);
  EXPECT_TRUE(std::isfinite(radial_distribution(GranularLaw{}, 0.7)));
}

TEST(KineticTheory, DilutePressureIsThatOfAGas) {
  EXPECT_NEAR(granular_pressure({}, {1e-6, 1000, 1e-3}, 0.5), 1e-6 * 1000 * 0.5, 1e-8);
}

// Chapman & Enskog: 5/96 sqrt(pi) rho d sqrt(T) of a dilute gas of elastic spheres.
TEST(KineticTheory, DiluteViscosityIsThatOfAGas) {
  GranularLaw law;
  law.restitution = 1;
  const double expected = 5.0 / 96 * std::sqrt(std::numbers::pi) * 1000 * 1e-3 * std::sqrt(0.5);
  EXPECT_NEAR(granular_viscosity(law, {1e-9, 1000, 1e-3}, 0.5), expected, 2e-3 * expected);
}

TEST(KineticTheory, SyamlalsViscosityOfAHandValue) {
  GranularLaw law;
  law.viscosity = FlightViscosity::syamlal;
  const double g0 = radial_distribution(law, 0.3), pi = std::numbers::pi, scale = 1000 * 315e-6;
  const double expected = 0.8 * 0.09 * scale * g0 * 1.9 / std::sqrt(pi) +
                          0.3 * scale * std::sqrt(pi) / (6 * 2.1) * (1 + 0.4 * 1.9 * 1.7 * 0.3 * g0);
  EXPECT_NEAR(granular_viscosity(law, medium, 1), expected, 1e-12 * expected);
}

// So many collisions a second and volume, 2 n^2 d^2 sqrt(pi T) g0, and m (1 - e^2) T lost in each.
TEST(KineticTheory, DissipationIsWhatCollisionsLose) {
  const GranularLaw law;
  const double pi = std::numbers::pi, d = medium.diameter, t = 0.2, volume = pi * d * d * d / 6;
  const double n = medium.fraction / volume, mass = medium.density * volume;
  const double collisions = 2 * n * n * d * d * std::sqrt(pi * t) * radial_distribution(law, medium.fraction);
  const double expected = collisions * mass * (1 - law.restitution * law.restitution) * t;
  EXPECT_NEAR(dissipation(law, medium, t), expected, 1e-12 * expected);
}

TEST(KineticTheory, BulkViscosityOfAHandValue) {
  const GranularLaw law;
  const double expected = 4.0 / 3 * 0.09 * 1000 * 315e-6 * radial_distribution(law, 0.3) *
                          (1 + law.restitution) * std::sqrt(0.2 / std::numbers::pi);
  EXPECT_NEAR(bulk_viscosity(law, medium, 0.2), expected, 1e-12 * expected);
}

TEST(KineticTheory, FrictionBeginsWhereItIsToldAndStaysFinite) {
  const GranularLaw law;
  EXPECT_EQ(frictional_pressure(law, 0.6), 0);
  EXPECT_NEAR(frictional_pressure(law, 0.62), 0.1 * 0.62 * 1e-4 / 1e-10, 1e-6 * 6.2e4);
  EXPECT_TRUE(std::isfinite(frictional_pressure(law, 0.63)));
  EXPECT_GT(frictional_pressure(law, 0.7), frictional_pressure(law, 0.63));
}

TEST(KineticTheory, SlopeIsThatOfThePressure) {
  const GranularLaw law;
  for (const double eps : {0.05, 0.3, 0.6, 0.615, 0.625}) {
    const auto pressure = [&](double fraction) {
      return granular_pressure(law, {fraction, 1000, 1e-3}, 0.2) + frictional_pressure(law, fraction);
    };
    const double h = 1e-7, expected = (pressure(eps + h) - pressure(eps - h)) / (2 * h);
    EXPECT_NEAR(pressure_slope(law, {eps, 1000, 1e-3}, 0.2), expected, 1e-3 * expected) << eps;
  }
}

TEST(KineticTheory, TemperatureBalancesProductionAndLoss) {
  for (const double divergence : {-50.0, 0.0, 50.0})
    for (const double exchange : {0.0, 300.0}) {
      const GranularLaw law;
      const Strain strain{divergence, 2000 + divergence * divergence};
      const double t = algebraic_temperature(law, medium, strain, exchange);
      const double mu = granular_viscosity(law, medium, t);
      const double production = -granular_pressure(law, medium, t) * divergence + 2 * mu * strain.squared +
                                (bulk_viscosity(law, medium, t) - 2.0 / 3 * mu) * divergence * divergence;
      EXPECT_GT(t, 0);
      EXPECT_NEAR(production, dissipation(law, medium, t) + 3 * exchange * t,
                  1e-9 * std::abs(production) + 1e-9);
    }
}

TEST(KineticTheory, NothingMovesWithoutStrain) {
  EXPECT_EQ(algebraic_temperature({}, medium, {}), 0);
  EXPECT_EQ(algebraic_temperature({}, {0, 1000, 1e-3}, {1, 1}), 0);
}

TEST(KineticTheory, SchaeffersViscosityCarriesCoulombsShare) {
  const GranularLaw law;
  // Simple shear at rate 10: D:D = 50, I2D = 25; stress 2 mu sqrt(I2D) = p sin(angle).
  const double mu = frictional_viscosity(law, 0.62, {0, 50});
  EXPECT_NEAR(2 * mu * 5, frictional_pressure(law, 0.62) * std::sin(0.5), 1e-9);
}

}  // namespace
}  // namespace elrom::particle
