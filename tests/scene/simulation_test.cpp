// Scenes as a whole: forces against closed forms, what is not named costs nothing, openings, resuming.
#include "elrom/scene/simulation.hpp"

#include <cstdlib>
#include <new>

#include "elrom/base/error.hpp"
#include "elrom/scene/scene_run.hpp"
#include "spheres_for_tests.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

// Sanitizers bring their own. Not inlined, or GCC takes free() for a mistake.
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
#define ELROM_COUNTS_ALLOCATIONS 1
static std::size_t allocated_bytes = 0;
[[gnu::noinline]] void* operator new(std::size_t n) {
  __atomic_fetch_add(&allocated_bytes, n, __ATOMIC_RELAXED);
  if (void* const memory = std::malloc(n)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
#endif

namespace elrom::scene {
namespace {

// A box, one group of spheres, and whatever else.
SceneSettings scene(const std::string& more, int number = 1, const std::string& group_more = "",
                    const std::string& step = "0.001", const std::string& duration = "1") {
  return parse_scene("[scene]\nduration = " + duration + "\ntime_step = " + step + "\n" + more +
                         "\n[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [0.02, 0.02, 0.02]\n"
                         "[[regions]]\nname = \"bottom\"\nlow = [0, 0, 0]\nhigh = [0.02, 0.02, 0.005]\n"
                         "[[regions]]\nname = \"top\"\nlow = [0, 0, 0.01]\nhigh = [0.02, 0.02, 0.02]\n"
                         "[[particles]]\ngroup = \"a\"\ndiameter = \"315 um\"\nnumber = " +
                         std::to_string(number) + "\n" + group_more,
                     "test.toml");
}

void run_all(Simulation& simulation) {
  while (!simulation.done()) simulation.step();
}

double falling_speed(double diameter, const std::string& step, const std::string& collisions) {
  auto s = scene(
      "[domain]\nperiodic = [\"x\", \"y\", \"z\"]\n[gas]\nmodel = \"uniform\"\n[effects]\ngravity = [0, 0, -9.81]\n"
      "buoyancy = true\ndrag = \"schiller_naumann\"\ncollisions = \"" +
          collisions + "\"",
      1, "", step, "10");
  s.groups[0].diameter = diameter;
  Simulation simulation(s, 1);
  run_all(simulation);
  return -simulation.state().particles.velocity[2][0];
}

TEST(SceneGroups, AsManySpheresAsMakeUpTheMass) {
  auto s = scene("");
  s.groups[0].number.reset();
  s.groups[0].mass = 2e-6;
  const Simulation simulation(s, 1);
  const auto& spheres = simulation.state().particles;

  EXPECT_GE(mass_of(spheres), 2e-6);
  EXPECT_LT(mass_of(spheres), 2e-6 + spheres.mass[0]);
}

TEST(SceneForces, TerminalVelocityIsTheClosedOneAtAnyStep) {
  for (const double d : {315e-6, 475e-6, 3e-3})
    for (const auto* step : {"0.001", "0.01", "0.5"}) {
      const double expected = particle::terminal_speed(d, 1000, {});
      EXPECT_NEAR(falling_speed(d, step, "none"), expected, 1e-4 * expected) << d << " " << step;
    }
  const double expected = particle::terminal_speed(315e-6, 1000, {});
  EXPECT_NEAR(falling_speed(315e-6, "0.01", "helscm"), expected, 1e-4 * expected);
}

TEST(SceneForces, FreeFallIsExact) {
  auto s = scene("[domain]\nperiodic = [\"x\", \"y\", \"z\"]\n[effects]\ngravity = [0, 0, -10]", 1, "",
                 "0.01", "0.03");
  Simulation simulation(s, 1);
  const double start = simulation.state().particles.place[2][0];
  run_all(simulation);
  EXPECT_NEAR(simulation.state().particles.velocity[2][0], -0.3, 1e-15);
  EXPECT_NEAR(simulation.state().particles.place[2][0], start - 0.0045, 1e-15);
}

TEST(SceneForces, StokesDragDecaysExponentially) {
  auto s = scene(
      "[domain]\nperiodic = [\"x\", \"y\", \"z\"]\n[gas]\nmodel = \"uniform\"\nvelocity = [1, 0, 0]\n"
      "[effects]\ndrag = \"stokes\"",
      1, "", "0.01", "0.1");
  Simulation simulation(s, 1);
  run_all(simulation);
  const double rate = 18 * 1.84e-5 / (1000 * 315e-6 * 315e-6);
  EXPECT_NEAR(simulation.state().particles.velocity[0][0], 1 - std::exp(-0.1 * rate), 1e-12);
}

TEST(SceneForces, FrozenFieldIsTrilinearBetweenItsCells) {
  const MatrixD centres = [] {
    MatrixD c(27, 3);
    for (Eigen::Index k = 0; k < 27; ++k)
      c.row(k) << static_cast<double>(k % 3), static_cast<double>(k / 3 % 3), static_cast<double>(k / 9);
    return c;
  }();
  MatrixD velocities(27, 3);
  for (Eigen::Index k = 0; k < 27; ++k) velocities.row(k) << 2 * centres(k, 0), 1, -centres(k, 2);
  const auto gas = frozen_gas(centres, velocities, 1);
  Particles p;
  p.add({{0.5, 0.25, 1.5}, {}, 1e-3, 1000});
  p.add({{-5, 0, 7}, {}, 1e-3, 1000});
  std::array<Vec, 2> found;
  gas->velocity(p.place, 0, found);
  EXPECT_NEAR(found[0].x, 1, 1e-4);
  EXPECT_NEAR(found[0].y, 1, 1e-12);
  EXPECT_NEAR(found[0].z, -1.5, 1e-4);
  EXPECT_NEAR(found[1].x, 0, 1e-4);
  EXPECT_NEAR(found[1].z, -2, 1e-4);
}

TEST(SceneEffects, WhatIsNotNamedIsNotThere) {
  Simulation plain(scene("", 100), 1);
  plain.step();
  ASSERT_EQ(plain.costs().size(), 2u);
  EXPECT_EQ(plain.costs()[1].name, "motion");
  EXPECT_EQ(plain.costs()[1].bytes, 0);
  EXPECT_TRUE(plain.state().push[0].empty());
  EXPECT_EQ(plain.state().particles.spin[0].capacity(), 0u);
  EXPECT_EQ(plain.state().particles.last_hit.capacity(), 0u);

  Simulation full(
      scene(
          "[gas]\nmodel = \"uniform\"\n[effects]\ngravity = [0, 0, -9.81]\nbuoyancy = true\nrotation = true\n"
          "drag = \"stokes\"\ncollisions = \"dem\"",
          100),
      1);
  full.step();
  std::vector<std::string> names;
  for (const auto& cost : full.costs()) names.push_back(cost.name);
  EXPECT_THAT(names, testing::ElementsAre("particles", "forces", "gravity", "buoyancy", "drag stokes",
                                          "collisions dem"));
  EXPECT_GT(full.costs()[5].bytes, 0);
}

#ifdef ELROM_COUNTS_ALLOCATIONS
// Bytes that a sphere more asks for, in a scene's first step.
double bytes_a_sphere(const std::string& effects) {
  const auto all = [&](int number) {
    Simulation simulation(scene(effects, number, "arrangement = \"lattice\""), 1);
    const auto placed = allocated_bytes;
    simulation.step();
    return static_cast<double>(allocated_bytes - placed);
  };
  return (all(3000) - all(1000)) / 2000;
}

TEST(SceneEffects, WhatIsNotNamedAllocatesNothing) {
  EXPECT_EQ(bytes_a_sphere(""), 0);
  // One push a sphere, however many forces.
  EXPECT_EQ(bytes_a_sphere("[effects]\ngravity = [0, 0, -9.81]"), 24);
  EXPECT_EQ(
      bytes_a_sphere("[gas]\nmodel = \"uniform\"\n[effects]\ngravity = [0, 0, -9.81]\ndrag = \"stokes\""),
      24);
  EXPECT_GT(bytes_a_sphere("[effects]\ncollisions = \"helscm\""), 12);
}
#endif

TEST(SceneOpenings, RecirculationKeepsNumberMassAndDiameters) {
  auto s = scene(
      "[domain]\noutlets = [\"box.z_high\"]\n[effects]\nrecirculation = \"bottom\"\ncollisions = \"helscm\"",
      200, "region = \"top\"\nvelocity = [0, 0, 2]\ndistribution = \"normal\"\ndeviation = \"20 um\"",
      "0.001", "0.05");
  s.recirculation_velocity = {0, 0, 2};
  Simulation simulation(s, 1);
  const auto sorted = [](const State& state) {
    auto d = state.particles.diameter;
    for (const auto& sphere : state.waiting) d.push_back(sphere.diameter);
    std::ranges::sort(d);
    return d;
  };
  const auto before = sorted(simulation.state());
  run_all(simulation);
  EXPECT_EQ(sorted(simulation.state()), before);
  EXPECT_GT(simulation.state().tally.returned, 500);
  EXPECT_EQ(overlaps_of(simulation.state().particles, simulation.domain(), 1e-6, 1).n, 0u);
}

TEST(SceneOpenings, InletsComeOverTimeAndOutletsTake) {
  auto s = scene("[domain]\noutlets = [\"box.z_high\"]", 100,
                 "region = \"bottom\"\nvelocity = [0, 0, 1]\nover = \"20 ms\"", "0.001", "0.01");
  Simulation simulation(s, 1);
  EXPECT_EQ(simulation.state().particles.size(), 0u);
  run_all(simulation);
  EXPECT_EQ(simulation.state().particles.size(), 50u);
  EXPECT_EQ(simulation.due(), 50);
  auto longer = simulation.settings();
  longer.duration = 0.1;
  Simulation second(longer, 1);
  run_all(second);
  EXPECT_EQ(second.state().tally.left, 100);
  EXPECT_EQ(second.state().particles.size(), 0u);
}

TEST(SceneOpenings, SpheresWithoutRoomAreRefused) {
  EXPECT_ERROR(UsageError, "no room for the spheres", Simulation(scene("", 200000), 1));
  EXPECT_ERROR(UsageError, "did you mean 'bottom'", Simulation(scene("", 1, "region = \"botom\""), 1));
  EXPECT_ERROR(
      InputError, "nowhere.elrom",
      Simulation(scene("[effects]\ncollisions = \"helscm\"\n[collisions]\nmodel = \"nowhere.elrom\""), 1));
}

TEST(SceneOpenings, LatticeIsDenserThanChance) {
  Simulation simulation(scene("", 100000, "arrangement = \"lattice\""), 1);
  EXPECT_EQ(overlaps_of(simulation.state().particles, simulation.domain(), 1e-9, 1).n, 0u);
}

const std::string busy =
    "[grid]\ncell = [0.005, 0.005, 0.005]\n[domain]\noutlets = [\"box.z_high\"]\n[gas]\nmodel = \"uniform\"\nvelocity = [0, 0, 3]\n[output]\nevery = 0.002\n"
    "checkpoint_every = 0.002\n[effects]\ndrag = \"schiller_naumann\"\ngravity = [0, 0, -9.81]\nrecirculation = \"bottom\"\nrotation = true\n";

class SceneResume : public testing::TestWithParam<const char*> {
 protected:
  static SceneSettings settings(const std::string& duration) {
    const std::string walls = std::string(GetParam()) == "dem" ? "walls = \"dem\"\n" : "";
    return scene(busy + walls + "collisions = \"" + GetParam() + "\"\n[collisions]\nfriction = 0.2\n", 300,
                 "velocity = [0.3, 0.1, 1]\nscatter = 0.5", "0.001", duration);
  }
  static void run_in(const std::filesystem::path& folder, const std::string& duration, int threads) {
    Simulation simulation(settings(duration), threads);
    run(simulation, folder, silent_log(), {});
  }
};

TEST_P(SceneResume, EndsInTheSameBytesAndThreadsToo) {
  const test::TemporaryFolder folder;
  run_in(folder / "whole", "0.012", 1);
  run_in(folder / "parts", "0.006", 1);
  run_in(folder / "parts", "0.012", 3);

  for (const auto* name : {"checkpoint.elrom", "series.csv", "particles_000000000012.vtp", "particles.pvd"})
    EXPECT_EQ(test::read_bytes(folder / "whole" / name), test::read_bytes(folder / "parts" / name)) << name;
  EXPECT_GT(test::read_bytes(folder / "whole" / "checkpoint.elrom").size(), 10000u);
}

INSTANTIATE_TEST_SUITE_P(, SceneResume, testing::Values("none", "dem", "hel", "helscm", "helscm_document"));

TEST(SceneCheckpoint, OfAnotherSceneOrDamagedIsRefused) {
  Simulation one(scene("", 5), 1), other(scene("", 6), 1);
  const test::TemporaryFolder folder;
  one.save().write(folder / "c");
  EXPECT_ERROR(InputError, "belongs to another scene", other.load(io::TensorFile::open(folder / "c")));
  auto damaged = one.save();
  damaged.set("diameter", io::Tensor::copy(std::vector<double>(5, -1.0), {5}));
  EXPECT_ERROR(InputError, "damaged checkpoint", one.load(damaged));
}

// A tensor file's header takes 4 MiB; ten seconds of sections are longer.
TEST(SceneCheckpoint, TablesMayBeLongerThanAHeader) {
  const test::TemporaryFolder folder;
  const auto run_for = [&](const std::string& duration) {
    Simulation simulation(
        scene("[output]\nevery = 0.001\ncheckpoint_every = 0.001\n[[probes.sections]]\nname = \"all\"\n"
              "low = [0, 0, 0]\nhigh = [0.02, 0.02, 0.02]\ncells = [40, 50, 50]\n",
              1, "", "0.001", duration),
        1);
    run(simulation, folder / "o", silent_log(), {});
  };
  run_for("0.001");
  run_for("0.002");

  EXPECT_GT(std::filesystem::file_size(folder / "o" / "section_all.csv"), std::size_t{3} * 4'194'304);
}

TEST(SceneHardCases, EndInFiniteNumbers) {
  for (const auto* collisions : {"none", "dem", "helscm", "helscm_document"})
    for (const int number : {0, 1, 20})
      for (const std::string step : {"1e-6", "1e-2"}) {
        // Contacts at 400 m/s ask for steps of nanoseconds.
        if (step == "1e-2" && std::string(collisions) == "dem") continue;
        const auto* duration = step == "1e-6" ? "5e-6" : "0.01";
        Simulation simulation(scene(std::string("[effects]\ncollisions = \"") + collisions + "\"", number,
                                    "velocity = [200, 100, 50]\nscatter = 20", step, duration),
                              1);
        const double energy = kinetic_energy_of(simulation.state().particles);
        run_all(simulation);
        EXPECT_LE(kinetic_energy_of(simulation.state().particles), energy * (1 + 1e-12))
            << collisions << number << step;
      }
}

TEST(SceneHardCases, DensePackingUnderGravityAtEveryStep) {
  for (const auto* collisions : {"hel", "helscm", "helscm_document", "dem"})
    for (const std::string step : {"1e-6", "1e-4", "1e-2"}) {
      // Contacts ask for steps of 0.2 us.
      if (step != "1e-6" && std::string(collisions) == "dem") continue;
      const auto* duration = step == "1e-2" ? "0.02" : step == "1e-4" ? "1e-3" : "1e-5";
      Simulation simulation(scene("[grid]\ncell = [0.002, 0.002, 0.002]\n[effects]\ngravity = [0, 0, -9.81]\n"
                                  "collisions = \"" +
                                      std::string(collisions) + "\"",
                                  20000, "arrangement = \"lattice\"", step, duration),
                            1);
      run_all(simulation);
      EXPECT_LT(greatest_speed_of(simulation.state().particles), 2) << collisions << step;
      EXPECT_EQ(simulation.state().particles.size(), 20000u);
    }
}

TEST(SceneHardCases, CornerHoldsWhatIsThrownIntoIt) {
  for (const auto* collisions : {"none", "hel", "helscm", "helscm_document"}) {
    Simulation simulation(
        scene("[grid]\ncell = [0.002, 0.002, 0.002]\n[walls]\nnormal_restitution = 0.5\n"
              "tangential_restitution = 0.5\n[effects]\ngravity = [-50, -50, -50]\ncollisions = \"" +
                  std::string(collisions) + "\"",
              100, "velocity = [-200, -200, -200]", "1e-3", "0.02"),
        1);
    run_all(simulation);
    for (std::size_t i = 0; i < 100; ++i)
      EXPECT_GT(simulation.domain().distance(get(simulation.state().particles.place, i)), 0.1574e-3)
          << collisions;
  }
}

TEST(SceneHardCases, TenSizesFrom50UmTo5Mm) {
  std::string groups;  // the largest first, while there is room
  for (int k = 9; k >= 0; --k)
    groups += "\n[[particles]]\ngroup = \"g" + std::to_string(k) +
              "\"\nnumber = " + std::to_string(k == 9 ? 2 : 40) +
              "\ndiameter = " + std::to_string(50e-6 * std::pow(100.0, k / 9.0)) +
              "\nscatter = 1\nregion = \"box\"";
  Simulation simulation(scene("[effects]\ncollisions = \"helscm\"", 0, groups, "0.001", "0.01"), 1);
  const double energy = kinetic_energy_of(simulation.state().particles);
  run_all(simulation);
  EXPECT_LT(kinetic_energy_of(simulation.state().particles), energy);
  EXPECT_GT(simulation.state().tally.collisions, 0);
  EXPECT_EQ(overlaps_of(simulation.state().particles, simulation.domain(), 1e-6, 1).n, 0u);
}

}  // namespace
}  // namespace elrom::scene
