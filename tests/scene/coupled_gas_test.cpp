// Gas and spheres together: momentum to rounding, beds that weigh what the pressure falls, hard cases.
#include "elrom/base/log.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/csv.hpp"
#include "elrom/scene/scene_run.hpp"
#include "elrom/scene/simulation.hpp"
#include "spheres_for_tests.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::scene {
namespace {

SceneSettings bed(const std::string& speed, const std::string& collisions, const std::string& number,
                  const std::string& duration, const std::string& gravity = "-9.81",
                  const std::string& step = "1e-3") {
  return parse_scene("[scene]\nduration = " + duration + "\ntime_step = " + step +
                         "\n[domain]\noutlets = [\"box.z_high\"]\n[gas]\nmodel = \"coupled\"\n[grid]\n"
                         "cell = [\"2.5 mm\", \"2.5 mm\", \"2.5 mm\"]\n[effects]\ngravity = [0, 0, " +
                         gravity +
                         "]\nbuoyancy = true\ndrag = \"gidaspow\"\nrecirculation = \"box\"\ncollisions = \"" +
                         collisions +
                         "\"\n[walls]\nnormal_restitution = 0.8\ntangential_restitution = 0.8\n"
                         "[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [0.01, 0.01, 0.04]\n"
                         "[[regions]]\nname = \"bottom\"\nlow = [0, 0, 0]\nhigh = [0.01, 0.01, 0.02]\n"
                         "[[gas.inlets]]\nside = \"box.z_low\"\nvelocity = [0, 0, " +
                         speed +
                         "]\n[[particles]]\ngroup = \"a\"\ndiameter = \"475 um\"\nregion = \"bottom\"\n"
                         "arrangement = \"lattice\"\nparcels = " +
                         (collisions == "hel" ? "4" : "1") + "\nnumber = " + number,
                     "bed.toml");
}

// Means over a run from some time on: the pressure on the inlet, and what gas lifts by drag and pressure, Pa.
struct Means {
  double pressure = 0, lift = 0;
};
Means means(Simulation& simulation, double from) {
  Means sum;
  double n = 0;
  while (!simulation.done()) {
    simulation.step();
    if (simulation.state().time < from) continue;
    const auto& p = simulation.state().particles;
    for (std::size_t i = 0; i < std::min(p.size(), simulation.state().push[2].size()); ++i)
      sum.lift += p.mass[i] * (simulation.state().push[2][i] + (1 - 1.184 / 1000) * 9.81) / 1e-4;
    sum.pressure += simulation.flow()->inlet_pressure(), ++n;
  }
  return {sum.pressure / n, sum.lift / n};
}

double weight_per_area(const Simulation& simulation) {
  return mass_of(simulation.state().particles) * (1 - 1.184 / 1000) * 9.81 / 1e-4;
}

// Few parcels in many cells: by the number of parcels alone, the gas would cost a sixth. Another process
// may take the machine at any time, in the trial or in the run: the shortest of some attempts are compared.
TEST(SceneCoupledGas, CostIsEstimatedWithinAFactorOfTwo) {
  double estimated = HUGE_VAL, measured = HUGE_VAL;
  for (int k = 0; k < 20; ++k) {
    Simulation simulation(bed("0.2", "hel", "80", "0.02"), 1);
    simulation.try_cells();
    while (!simulation.done()) simulation.step();
    for (const auto& cost : simulation.costs()) {
      if (!cost.name.starts_with("coupled gas")) continue;
      estimated = std::min(estimated, cost.seconds_estimated);
      measured = std::min(measured, cost.seconds);
    }
  }
  EXPECT_LT(std::abs(std::log(estimated / measured)), std::log(2)) << estimated << " for " << measured;
}

// The bed is three cells deep: what its dead corners stand on the floor with is not small.
TEST(SceneCoupledGas, FluidisedBedHangsOnThePressure) {
  Simulation simulation(bed("0.2", "hel", "8000", "0.6"), 1);
  const double mass = mass_of(simulation.state().particles);
  const auto [pressure, lift] = means(simulation, 0.3);
  const double weight = weight_per_area(simulation);
  EXPECT_NEAR(pressure, lift, 0.01 * weight);  // the gas's friction on walls takes some of it
  EXPECT_GT(pressure, 0.8 * weight);
  EXPECT_LT(pressure, 1.1 * weight);
  EXPECT_EQ(mass_of(simulation.state().particles), mass);
  EXPECT_LT(simulation.flow()->divergence(), 1e-8);
  EXPECT_NEAR(simulation.flow()->flow_in(), 0.2 * 1e-4, 1e-15);
}

// Eight planes of half a layer of cells each: a plane has the pressure of the layer's sixteen cells if their
// centres lie in it, and none otherwise.
TEST(SceneCoupledGas, SectionsHaveTheMeanPressureOfTheCellsInThem) {
  const test::TemporaryFolder folder;
  auto settings = bed("0.2", "hel", "800", "0.003");
  settings.sections = {{.name = "planes", .low = {0, 0, 0}, .high = {0.01, 0.01, 0.01}, .cells = {1, 1, 8}}};
  Simulation simulation(settings, 1);
  run(simulation, folder / "o", silent_log(), {});

  const auto table = io::read_csv(folder / "o" / "section_planes.csv");
  ASSERT_EQ(table.headings.back(), "gas_pressure [Pa]");
  const auto& pressure = simulation.flow()->pressure();
  for (std::size_t plane = 0; plane < 8; ++plane) {
    const auto& row = table.rows[table.rows.size() - 8 + plane];
    double mean = 0;
    if (plane % 2 == 1)  // centres are at 1.25 mm, the border between two planes, and count as above it
      for (std::size_t c = 0; c < 16; ++c) mean += pressure[plane / 2 * 16 + c] / 16;
    EXPECT_NEAR(base::to_double(row.back()).value(), mean, 1e-9 * std::abs(pressure[0])) << plane;
  }
  EXPECT_GT(pressure[0], 0);
}

TEST(SceneCoupledGas, SeriesNamesEveryColumnOfTheGas) {
  const test::TemporaryFolder folder;
  Simulation simulation(bed("0.2", "hel", "80", "0.003"), 1);
  run(simulation, folder / "o", silent_log(), {});

  const auto table = io::read_csv(folder / "o" / "series.csv");
  const auto& last = table.rows.back();
  const auto column = std::ranges::find(table.headings, "gas flow in [m3/s]") - table.headings.begin();
  ASSERT_EQ(last.size(), table.headings.size());
  ASSERT_LT(static_cast<std::size_t>(column), last.size());
  EXPECT_NEAR(base::to_double(last[static_cast<std::size_t>(column)]).value(), 0.2 * 1e-4, 1e-12);
}

TEST(SceneCoupledGas, BedBelowFluidisationCarriesOnlyWhatErgunSays) {
  Simulation simulation(bed("0.03", "hel", "8000", "0.6"), 1);
  const double pressure = means(simulation, 0.4).pressure, weight = weight_per_area(simulation);
  EXPECT_LT(pressure, 0.6 * weight);
  EXPECT_GT(pressure, 0.2 * weight);
  EXPECT_LT(greatest_speed_of(simulation.state().particles), 0.2);
}

TEST(SceneCoupledGas, WhatSpheresGetTheGasLoses) {
  auto s = parse_scene(
      "[scene]\nduration = 1\ntime_step = 1e-3\n[domain]\nperiodic = [\"x\", \"y\", \"z\"]\n[gas]\nmodel = \"coupled\"\n"
      "[grid]\ncell = [0.0025, 0.0025, 0.0025]\n[effects]\ndrag = \"wen_yu\"\n"
      "[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [0.02, 0.02, 0.02]\n"
      "[[particles]]\ngroup = \"a\"\ndiameter = \"475 um\"\nnumber = 2000\nvelocity = [1, 2, -3]\nscatter = 1",
      "momentum.toml");
  Simulation simulation(s, 1);
  const Vec before = momentum_of(simulation.state().particles);
  // One kick: the gas begins at rest, so nothing is carried along yet.
  State state = simulation.state();
  const Domain domain = test::periodic_cube(0.02);
  GasFlow flow(domain, std::make_shared<CellGrid>(domain, Vec{0.0025, 0.0025, 0.0025}), {}, {});
  const auto effect = coupled_gas(DragLaw::wen_yu, flow, 1);
  for (auto& component : state.push) component.assign(state.particles.size(), 0);
  effect->apply(state, 1e-3);
  std::array<double, 3> gained{}, gas{};
  std::array<std::vector<double>, 3> solids;
  for (std::size_t a = 0; a < 3; ++a) {
    solids[a].assign(flow.grid().face_count(a), 0);
    for (std::size_t i = 0; i < state.particles.size(); ++i) {
      gained[a] += 1e-3 * state.particles.mass[i] * state.push[a][i];
      const auto shares = flow.grid().faces(get(state.particles.place, i), a);
      for (std::size_t k = 0; k < 8; ++k)
        solids[a][static_cast<std::size_t>(shares.of[k])] +=
            shares.weight[k] * state.particles.volume(i) /
            flow.grid().face_volume(a, static_cast<std::size_t>(shares.of[k]));
    }
    for (std::size_t c = 0; c < flow.grid().size(); ++c) {
      const auto f = flow.grid().face(c, a, -1);
      gas[a] += flow.grid().volume() * 1.184 * (1 - solids[a][f]) * flow.velocity()[a][f];
    }
    EXPECT_GT(std::abs(gained[a]), 0.01 * std::abs(a == 0 ? before.x : before.z) * 1e-3);
    // The gas's own friction, which is not in the form of fluxes, makes 1e-5 of it.
    EXPECT_NEAR(gas[a], -gained[a], 2e-5 * std::abs(gained[a])) << a;
  }
}

TEST(SceneCoupledGas, HardCasesStayFinite) {
  for (const auto* collisions : {"hel", "helscm", "none"})
    for (const auto* number : {"0", "1", "2000"})
      for (const std::string step : {"1e-5", "1e-2"}) {
        Simulation simulation(bed("2", collisions, number, step == "1e-2" ? "0.05" : "5e-5", "0", step), 1);
        const auto n = simulation.state().particles.size();
        while (!simulation.done()) simulation.step();
        EXPECT_TRUE(std::isfinite(simulation.flow()->inlet_pressure())) << collisions << number << step;
        EXPECT_EQ(simulation.state().particles.size() + simulation.state().waiting.size(), n);
        EXPECT_LT(simulation.flow()->divergence(), 1e-6);
      }
}

TEST(SceneCoupledGas, SphereFallsThroughGasAtItsTerminalSpeed) {
  auto s = parse_scene(
      "[scene]\nduration = 0.6\ntime_step = 5e-3\n[domain]\noutlets = [\"box.z_high\"]\n[gas]\nmodel = \"coupled\"\n"
      "[grid]\ncell = [0.01, 0.01, 0.01]\n[effects]\ngravity = [0, 0, -9.81]\nbuoyancy = true\ndrag = \"wen_yu\"\n"
      "[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [0.05, 0.05, 1]\n"
      "[[regions]]\nname = \"top\"\nlow = [0.02, 0.02, 0.9]\nhigh = [0.03, 0.03, 0.95]\n"
      "[[particles]]\ngroup = \"a\"\ndiameter = \"315 um\"\nregion = \"top\"\nnumber = 1",
      "fall.toml");
  Simulation simulation(s, 1);
  while (!simulation.done()) simulation.step();
  const double expected = particle::terminal_speed(315e-6, 1000, {});
  EXPECT_NEAR(-simulation.state().particles.velocity[2][0], expected, 0.01 * expected);
}

}  // namespace
}  // namespace elrom::scene
