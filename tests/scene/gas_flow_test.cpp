// The gas alone and through fixed solids: closed forms, published profiles, balances.
#include "elrom/scene/gas_flow.hpp"

#include "elrom/base/error.hpp"
#include "spheres_for_tests.hpp"
#include "support/throws.hpp"

namespace elrom::scene {
namespace {

// Between plates at z = 0 and 10 mm, driven by 1 N/m3 along x: u = z (H - z) / (2 mu), here in 16 cells.
TEST(SceneGasFlow, IsPoiseuillesBetweenPlates) {
  const double height = 0.01;
  const Domain domain({test::box({}, {0.002, 0.002, height})}, {}, {}, {"x", "y"});
  const particle::Gas gas{1, 1e-3};
  GasFlow flow(domain, std::make_shared<CellGrid>(domain, Vec{0.001, 0.001, height / 16}), gas, {},
               {1, 0, 0});
  for (int k = 0; k < 40; ++k) flow.advance(0.01, flow.no_load());
  const auto& g = flow.grid();
  for (std::size_t c = 0; c < g.size(); ++c) {
    const double z = g.centre(c).z, expected = z * (height - z) / (2 * gas.viscosity);
    EXPECT_NEAR(flow.velocity()[0][g.face(c, 0, -1)], expected, 0.01 * height * height / (8 * gas.viscosity))
        << z;
  }
}

// Ghia, Ghia & Shin (1982), Re = 100: u on the vertical line through the middle. The lid
// is a side whose gas moves along it.
TEST(SceneGasFlow, IsGhiasInACavity) {
  const particle::Gas gas{1, 0.01};
  const Domain thin({test::box({}, {1, 0.05, 1})}, {}, {}, {"y"});
  GasFlow flow(thin, std::make_shared<CellGrid>(thin, Vec{1.0 / 32, 0.05, 1.0 / 32}), gas,
               {{"box.z_high", {1, 0, 0}}});
  for (int k = 0; k < 60; ++k) flow.advance(0.25, flow.no_load());
  const auto& g = flow.grid();
  double least = 0;
  const std::vector<std::array<double, 2>> ghia{{0.1719, -0.10150}, {0.2813, -0.15662}, {0.4531, -0.21090},
                                                {0.6172, -0.13641}, {0.7344, 0.00332},  {0.8516, 0.23151}};
  const auto u_at = [&](double z) {
    const auto shares = g.faces({0.5, 0.025, z}, 0);
    double u = 0;
    for (std::size_t k = 0; k < 8; ++k)
      u += shares.weight[k] * flow.velocity()[0][static_cast<std::size_t>(shares.of[k])];
    return u;
  };
  for (const auto& [z, u] : ghia) {
    EXPECT_NEAR(u_at(z), u, 0.02) << z;
    least = std::min(least, u_at(z));
  }
  EXPECT_NEAR(least, -0.2109, 0.01);
  EXPECT_LT(flow.divergence(), 1e-8);
}

// A pipe full of solids that do not move: the pressure falls by Ergun's equation, and the flow is what came
// in.
TEST(SceneGasFlow, DropsThePressureOfAPackedBedByErgunsEquation) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.1})}, {"box.z_high"});
  const particle::Gas gas;
  const double u = 0.3, solids = 0.58, d = 475e-6, eps = 1 - solids;
  GasFlow flow(domain, std::make_shared<CellGrid>(domain, Vec{0.0025, 0.0025, 0.0025}), gas,
               {{"box.z_low", {0, 0, u}}});
  auto load = flow.no_load();
  const double volume = test::pi / 6 * d * d * d;
  const double beta = solids / volume * particle::drag_rate(particle::DragLaw::ergun, d, u / eps, eps, gas);
  for (std::size_t a = 0; a < 3; ++a) {
    std::ranges::fill(load.solids[a], solids);
    std::ranges::fill(load.exchange[a], beta);
  }
  for (int k = 0; k < 20; ++k) flow.advance(1e-3, load);
  const double slope = 150 * gas.viscosity * solids * solids * u / (eps * eps * eps * d * d) +
                       1.75 * gas.density * solids * u * u / (eps * eps * eps * d);
  EXPECT_NEAR(flow.inlet_pressure(), slope * 0.1, 0.005 * slope * 0.1);
  EXPECT_NEAR(flow.flow_in(), u * 1e-4, 1e-12);
  EXPECT_NEAR(flow.flow_out(), flow.flow_in(), 1e-9 * flow.flow_in());
  EXPECT_LT(flow.divergence(), 1e-8);
}

// Half a cell from an inlet to the first centre: there the gas's velocity is given, the drag on it is not.
TEST(SceneGasFlow, PressureOnAnInletHoldsTheDragOnItsFaces) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.02})}, {"box.z_high"});
  const double u = 0.3, solids = 0.5, beta = 1e4;
  GasFlow flow(domain, std::make_shared<CellGrid>(domain, Vec{0.0025, 0.0025, 0.0025}), {},
               {{"box.z_low", {0, 0, u}}});
  auto load = flow.no_load();
  for (std::size_t c = 0; c < 16; ++c) load.solids[2][c] = solids, load.exchange[2][c] = beta;
  for (int k = 0; k < 20; ++k) flow.advance(1e-3, load);
  const double drop = beta * u / (1 - solids) / (1 - solids) * 0.00125;
  EXPECT_NEAR(flow.inlet_pressure(), drop, 0.01 * drop);
  EXPECT_NEAR(flow.pressure_gradient()[2][0], -drop / 0.00125, 1e-9 * drop / 0.00125);
}

// A jet from the side into a shaft, nearly without viscosity: what goes up at the outlet is what presses and
// flows on the floor, for walls carry no momentum away.
TEST(SceneGasFlow, KeepsItsMomentumBetweenWalls) {
  const Domain domain({test::box({-0.02, -0.005, 0.005}, {-0.01, 0.005, 0.015}, "pipe"),
                       test::box({-0.01, -0.01, 0}, {0.01, 0.01, 0.04}, "shaft")},
                      {"shaft.z_high"}, {"pipe.x_high", "shaft.x_low"});
  const particle::Gas gas{1.2, 1e-9};
  const double u = 2, h = 0.0025;
  GasFlow flow(domain, std::make_shared<CellGrid>(domain, Vec{h, h, h}), gas, {{"pipe.x_low", {u, 0, 0}}});
  for (int k = 0; k < 400; ++k) flow.advance(2e-3, flow.no_load());
  const auto& g = flow.grid();
  const auto& w = flow.velocity()[2];
  double in = 0, out = 0;
  for (std::size_t c = 0; c < g.size(); ++c) {
    if (!g.is_open(c) || g.centre(c).x < -0.01) continue;
    const double z = g.centre(c).z, above = w[g.face(c, 2, 1)];
    // Half of what goes through the upper face of a cell on the floor passes its middle.
    if (z < h) in += (flow.pressure()[c] + 0.5 * gas.density * above * std::min(above, 0.0)) * h * h;
    if (z > 0.04 - h) out += gas.density * above * above * h * h;
  }
  EXPECT_NEAR(out, in, 0.05 * gas.density * u * u * 1e-4);  // the mouth of the pipe holds a little
}

TEST(SceneGasFlow, GasGivesWayToSolidsThatComeIn) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.02})}, {"box.z_high"});
  GasFlow flow(domain, std::make_shared<CellGrid>(domain, Vec{0.0025, 0.0025, 0.0025}), {}, {});
  auto load = flow.no_load();
  std::ranges::fill(load.solids_flux[2], -0.1);
  flow.advance(1e-3, load);
  EXPECT_NEAR(flow.flow_out(), 0.1 * 1e-4, 1e-12);
}

TEST(SceneGasFlow, RestsWhereNothingMovesIt) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.02})});
  GasFlow flow(domain, std::make_shared<CellGrid>(domain, Vec{0.0025, 0.0025, 0.0025}), {}, {});
  flow.advance(1, flow.no_load());
  for (const auto& component : flow.velocity())
    for (const double u : component) EXPECT_EQ(u, 0);
}

TEST(SceneGasFlow, LeaningInletGivesTheFlowOfItsSide) {
  const Domain domain({test::box({}, {0.05, 0.01, 0.01}), body_of({.name = "arm",
                                                                   .low = {-0.03, 0.002, 0.002},
                                                                   .high = {0.01, 0.008, 0.008},
                                                                   .turn_axis = 'y',
                                                                   .turn_angle = 0.4,
                                                                   .turn_about = {0.01, 0.005, 0.005}})},
                      {"box.x_high"});
  GasFlow flow(domain, std::make_shared<CellGrid>(domain, Vec{0.001, 0.001, 0.001}), {},
               {{"arm.x_low", {2 * std::cos(0.4), 0, -2 * std::sin(0.4)}}});
  flow.advance(1e-4, flow.no_load());
  EXPECT_NEAR(flow.flow_in(), 2 * 0.006 * 0.006, 1e-10);
  EXPECT_NEAR(flow.flow_out(), flow.flow_in(), 1e-6 * flow.flow_in());
}

TEST(SceneGasFlow, RefusesGasWithoutAWayOut) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.02})});
  const auto grid = std::make_shared<CellGrid>(domain, Vec{0.0025, 0.0025, 0.0025});
  EXPECT_ERROR(UsageError, "nowhere to go", GasFlow(domain, grid, {}, {{"box.z_low", {0, 0, 1}}}));
  EXPECT_ERROR(UsageError, "did you mean 'box.z_low'", GasFlow(domain, grid, {}, {{"box.z_lwo", {0, 0, 1}}}));
}

}  // namespace
}  // namespace elrom::scene
