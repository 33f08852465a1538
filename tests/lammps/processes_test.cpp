// elrom-simulate --engine lammps, as a user starts it, beside the native engine; what it refuses; and what
// comes of a rank that dies.
#include "elrom/lammps/processes.hpp"

#include <gmock/gmock.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>
#include <thread>

#include "elrom/base/error.hpp"
#include "elrom/scene/simulation.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::lammps {
namespace {

namespace fs = std::filesystem;

// One process alone needs no launcher's daemon, which takes OpenMPI a third of a second to start.
[[maybe_unused]] const int isolated = ::setenv("OMPI_MCA_ess_singleton_isolated", "1", 0);
using ::testing::HasSubstr;

// Two streams of 400 spheres each that cross, from when they meet until most of them have collided.
constexpr const char* crossing = R"(
[scene]
duration = 0.0012
time_step = 1e-4
[effects]
collisions = "helscm"
[collisions]
restitution = 0.9
stiffness = 5000
[output]
every = 6e-4
[[regions]]
name = "left"
low = [0, 0, 0]
high = [0.0118, 0.0059, 0.0059]
[[regions]]
name = "right"
low = [0.013, 0, 0]
high = [0.0248, 0.0059, 0.0059]
[[particles]]
group = "left"
region = "left"
diameter = "315 um"
number = 400
velocity = [9.4, 3.42, 0]
[[particles]]
group = "right"
region = "right"
diameter = "315 um"
number = 400
velocity = [-9.4, 3.42, 0]
)";

// Spheres of several sizes that fall, turn, rub and are carried along, between two walls and four periodic
// sides.
constexpr const char* duct = R"(
[scene]
duration = 0.02
time_step = 1e-3
[domain]
periodic = ["x", "y"]
[gas]
model = "uniform"
velocity = [2, 0, 0]
[effects]
gravity = [0, 0, -9.81]
rotation = true
drag = "schiller_naumann"
collisions = "helscm"
[walls]
normal_restitution = 0.8
[collisions]
restitution = 0.9
friction = 0.2
stiffness = 5000
[[domain.boxes]]
name = "duct"
low = [0, 0, 0]
high = [0.006, 0.006, 0.01]
[[particles]]
group = "a"
diameter = "400 um"
distribution = "normal"
deviation = "40 um"
smallest = "300 um"
largest = "500 um"
number = 120
scatter = 0.3
velocity = [0, 0, -1]
)";

class Engine : public ::testing::Test {
 protected:
  // Into a folder of its own. @param n_ranks 0: the native engine
  int run(const std::string& to, int n_ranks, const char* scene, const std::string& more = {}) const {
    const auto file = folder.write("scene.toml", scene);
    const std::string launcher = n_ranks > 1 ? ELROM_MPIEXEC " -n " + std::to_string(n_ranks) + " " : "";
    const auto command = launcher + ELROM_BIN_DIR "/elrom-simulate " + file.string() + " --output " +
                         (folder / to).string() + (n_ranks > 0 ? " --engine lammps " : " ") + more + " > " +
                         (folder / "out").string() + " 2> " + (folder / "err").string();
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::string errors() const { return test::read_bytes(folder / "err"); }
  [[nodiscard]] nlohmann::json summary(const std::string& of) const {
    return nlohmann::json::parse(test::read_bytes(folder / of / "summary.json"));
  }
  // The last row's.
  [[nodiscard]] double last(const std::string& of, const std::string& column) const {
    const auto table = test::read_bytes(folder / of / "series.csv");
    const auto cells = [](const std::string& line) {
      std::vector<std::string> cells;
      std::istringstream stream(line);
      for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
      return cells;
    };
    const auto heading = cells(table.substr(0, table.find('\n')));
    const auto at = std::ranges::find(heading, column) - heading.begin();
    return std::stod(
        cells(table.substr(table.rfind('\n', table.size() - 2) + 1)).at(static_cast<std::size_t>(at)));
  }
  // Runs of group a in which much happens.
  void expect_alike(const std::string& a, const std::string& b) const {
    EXPECT_GT(last(a, "collisions"), 50);
    EXPECT_GT(last(a, "wall_hits"), 50);
    for (const auto* column :
         {"collisions", "wall_hits", "kinetic_energy [J]", "mean height of a [m]", "momentum_x [kg m/s]"})
      EXPECT_NEAR(last(b, column), last(a, column), 1e-6 * std::abs(last(a, column))) << column;
  }
  test::TemporaryFolder folder;
};

TEST_F(Engine, CollidesLikeTheNativeOneInOneProcessAndInTwo) {
  ASSERT_EQ(run("native", 0, crossing), 0) << errors();
  const double collisions = last("native", "collisions"), energy = last("native", "kinetic_energy [J]");
  EXPECT_GT(collisions, 1000);
  for (const int n_ranks : {1, 2}) {
    const auto name = std::to_string(n_ranks);
    ASSERT_EQ(run(name, n_ranks, crossing), 0) << errors();
    EXPECT_NEAR(last(name, "collisions"), collisions, 0.01 * collisions) << name;
    EXPECT_NEAR(last(name, "collisions of left and right"), last("native", "collisions of left and right"),
                0.01 * collisions);
    EXPECT_NEAR(last(name, "kinetic_energy [J]"), energy, 1e-3 * energy);
    EXPECT_EQ(last(name, "spheres"), 800);
    const double momentum = last("native", "momentum_y [kg m/s]");  // 800 spheres at 3.42 m/s
    EXPECT_NEAR(last(name, "momentum_y [kg m/s]"), momentum, 1e-12 * momentum);
    EXPECT_NEAR(last(name, "momentum_x [kg m/s]"), 0, 1e-12 * momentum);
  }
}

TEST_F(Engine, GoesOnWhereTheOtherEngineStopped) {
  ASSERT_EQ(run("changed", 1, crossing, "--set scene.duration=6e-4"), 0) << errors();
  const double half = last("changed", "collisions");
  ASSERT_EQ(run("changed", 0, crossing), 0) << errors();

  EXPECT_EQ(summary("changed")["resumed_from"], 6);
  ASSERT_EQ(run("native", 0, crossing), 0) << errors();
  EXPECT_GT(half, 400);
  EXPECT_NEAR(last("changed", "collisions"), last("native", "collisions"),
              0.01 * last("native", "collisions"));
}

TEST_F(Engine, KnowsForcesWallsSizesSpinsAndPeriods) {
  ASSERT_EQ(run("native", 0, duct), 0) << errors();
  ASSERT_EQ(run("two", 2, duct), 0) << errors();

  expect_alike("native", "two");
}

// A wide box over a narrow one, for a gas alone and for spheres that fall through it as it was then.
constexpr const char* boxes = R"(
[[domain.boxes]]
name = "narrow"
low = [0, 0, 0]
high = [0.006, 0.006, 0.006]
[[domain.boxes]]
name = "wide"
low = [-0.002, -0.002, 0.006]
high = [0.008, 0.008, 0.014]
)";
constexpr const char* gas_alone = R"(
[scene]
duration = 0.01
time_step = 1e-3
[domain]
openings = ["narrow.z_high", "wide.z_low"]
outlets = ["wide.z_high"]
[gas]
model = "coupled"
[grid]
cell = [0.001, 0.001, 0.001]
[effects]
drag = "schiller_naumann"
[[gas.inlets]]
side = "narrow.z_low"
velocity = [0, 0, 0.5]
[[particles]]
group = "none"
diameter = "400 um"
number = 0
)";
constexpr const char* hopper = R"(
[scene]
duration = 0.02
time_step = 1e-3
[domain]
openings = ["narrow.z_high", "wide.z_low"]
[gas]
model = "frozen"
density = 200
[effects]
gravity = [0, 0, -9.81]
buoyancy = true
drag = "schiller_naumann"
collisions = "helscm"
[walls]
normal_restitution = 0.8
[collisions]
restitution = 0.9
stiffness = 5000
[[regions]]
name = "above"
low = [-0.002, -0.002, 0.006]
high = [0.008, 0.008, 0.014]
[[particles]]
group = "a"
region = "above"
diameter = "400 um"
number = 300
scatter = 0.2
velocity = [0, 0, -0.5]
)";

// A large sphere that meets a small one and throws it ahead, 1.8 times as fast as any was before.
constexpr const char* throws = R"(
[scene]
duration = 0.01
time_step = 1e-3
[effects]
collisions = "helscm"
[collisions]
restitution = 1
stiffness = 5000
[[regions]]
name = "behind"
low = [0, 0, 0]
high = [0.0035, 0.0035, 0.0035]
[[regions]]
name = "ahead"
low = [0.005, 0.001, 0.001]
high = [0.0065, 0.0025, 0.0025]
[[particles]]
group = "large"
region = "behind"
diameter = "3 mm"
number = 1
arrangement = "lattice"
velocity = [1, 0, 0]
[[particles]]
group = "small"
region = "ahead"
diameter = "0.9 mm"
number = 1
arrangement = "lattice"
)";

TEST_F(Engine, KnowsBoxesThatOpenIntoEachOtherBuoyancyAndAFrozenGas) {
  ASSERT_EQ(run("gas", 0, (std::string(gas_alone) + boxes).c_str()), 0) << errors();
  const auto scene = std::string(hopper) + boxes;
  const auto gas = "--set gas.file=" + (folder / "gas").string();
  ASSERT_EQ(run("native", 0, scene.c_str(), gas), 0) << errors();
  ASSERT_EQ(run("two", 2, scene.c_str(), gas), 0) << errors();

  expect_alike("native", "two");
}

// In this process, beside the native engine, to the end.
struct Both {
  explicit Both(const scene::SceneSettings& settings)
      : native(settings, 1), shared(settings, 1, this_process().movers(settings)) {
    for (auto* simulation : {&native, &shared})
      while (!simulation->done()) simulation->step();
    shared.gather();
  }
  // MPI cannot begin twice.
  static Processes& this_process() {
    static Processes processes;
    return processes;
  }
  void expect_alike(double tolerance) const {
    const auto &a = shared.state(), &b = native.state();
    EXPECT_EQ(a.tally.collisions, b.tally.collisions);
    EXPECT_EQ(a.tally.wall_hits, b.tally.wall_hits);
    ASSERT_EQ(a.particles.id, b.particles.id);
    for (std::size_t i = 0; i < a.particles.size(); ++i) {
      const auto apart = native.domain().images().nearest(scene::get(a.particles.place, i) -
                                                          scene::get(b.particles.place, i));
      EXPECT_LT(std::sqrt(scene::dot(apart, apart)), tolerance) << "sphere " << i;
    }
  }
  scene::Simulation native, shared;
};

TEST(LammpsProcesses, FollowsSpheresThatBecomeFasterThanAnyWas) {
  const Both both(scene::parse_scene(throws, "scene"));

  EXPECT_EQ(both.native.state().tally.collisions, 1);
  EXPECT_GT(greatest_speed_of(both.native.state().particles), 1.5);
  both.expect_alike(1e-12);
}

TEST(LammpsProcesses, MeetsASphereOnceThatIsNearOnTwoSidesOfAPeriod) {
  auto settings = scene::parse_scene(duct, "scene", {"scene.time_step=1e-4"});
  settings.boxes[0].high = {0.0009, 0.0009, 0.003};
  settings.groups[0].number = 3;

  const Both both(settings);

  EXPECT_GT(both.native.state().tally.collisions, 5);
  both.expect_alike(1e-7);
}

TEST(LammpsProcesses, CountsWhatIsPressedOnAWallOnce) {
  auto settings = scene::parse_scene(
      duct, "scene", {"scene.time_step=0.005", "scene.duration=0.2", "walls.normal_restitution=0.3"});
  settings.groups[0].number = 1;

  const Both both(settings);

  EXPECT_GT(both.native.state().tally.wall_hits, 0);
  both.expect_alike(1e-9);
}

TEST(LammpsProcesses, MovesNoSphereAndOneAtRest) {
  for (const int number : {0, 1}) {
    auto settings = scene::parse_scene(duct, "scene", {"effects.gravity=[0, 0, 0]", "effects.drag=none"});
    settings.groups[0].number = number, settings.groups[0].scatter = 0, settings.groups[0].velocity = {};

    const Both both(settings);

    EXPECT_EQ(both.shared.state().particles.size(), static_cast<std::size_t>(number));
    both.expect_alike(1e-15);
  }
}

TEST(LammpsProcesses, RefusesWhatItCannotDo) {
  // Of the duct with another line for its spheres, and another setting.
  const auto refusal = [&](const std::string& line,
                           const std::vector<std::string>& changes = {}) -> std::string {
    try {
      (void)Both::this_process().movers(scene::parse_scene(duct + line, "scene", changes));
    } catch (const UsageError& error) {
      return error.what();
    }
    return "not refused";
  };

  EXPECT_EQ(refusal(""), "not refused");
  EXPECT_THAT(refusal("", {"effects.collisions=dem"}),
              HasSubstr("found dem, expected effects.collisions = \"helscm\""));
  EXPECT_THAT(refusal("", {"effects.drag=wen_yu", "grid.cell=[0.002, 0.002, 0.002]"}),
              HasSubstr("voidage: found wen_yu"));
  EXPECT_THAT(refusal("", {"domain.outlets=[\"duct.z_low\"]"}), HasSubstr("outlets: found duct.z_low"));
  EXPECT_THAT(refusal("parcels = 2\n"), HasSubstr("parcels: found"));
  EXPECT_THAT(refusal("over = 0.01\n"), HasSubstr("inlets: found group 'a'"));
}

TEST_F(Engine, TellsAMistakeOnce) {
  EXPECT_EQ(run("wrong", 2, crossing, "--set effects.collisions=dem"), 2);
  const auto told = errors();
  EXPECT_THAT(told, HasSubstr("engine lammps cannot do these collisions"));
  EXPECT_EQ(told.find("cannot do"), told.rfind("cannot do")) << told;
}

pid_t process_of(const std::string& rank, const std::string& mark) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const auto name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    if (test::read_bytes(entry.path() / "cmdline").find(mark) != std::string::npos &&
        test::read_bytes(entry.path() / "environ").find("OMPI_COMM_WORLD_RANK=" + rank) != std::string::npos)
      return std::stoi(name);
  }
  return 0;
}

TEST_F(Engine, ARankThatDiesEndsTheJobWhichGoesOnFromItsCheckpoint) {
  const std::string often = "--set output.checkpoint_every=1e-4";
  ASSERT_EQ(run("whole", 2, crossing, often), 0) << errors();
  int status = 0;
  std::jthread job([&] { status = run("hit", 2, crossing, often); });
  const auto begin = std::chrono::steady_clock::now();
  while (!fs::exists(folder / "hit" / "checkpoint.elrom") &&
         std::chrono::steady_clock::now() - begin < std::chrono::seconds(60))
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const auto victim = process_of("1", (folder / "hit").string());
  ASSERT_NE(victim, 0);
  ::kill(victim, SIGKILL);
  job.join();
  EXPECT_NE(status, 0);
  while (process_of("0", (folder / "hit").string()) != 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));

  ASSERT_EQ(run("hit", 2, crossing, often), 0) << errors();

  EXPECT_GT(summary("hit")["resumed_from"], 0);
  EXPECT_EQ(test::read_bytes(folder / "hit" / "series.csv"),
            test::read_bytes(folder / "whole" / "series.csv"));
}

}  // namespace
}  // namespace elrom::lammps
