// A frozen gas from each kind of file: what a sphere meets is what the file tells.
#include "frozen_gas.hpp"

#include "elrom/base/error.hpp"
#include "elrom/scene/scene_run.hpp"
#include "elrom/scene/simulation.hpp"
#include "spheres_for_tests.hpp"
#include "support/throws.hpp"

namespace elrom::scene {
namespace {

Vec gas_at(const GasField& gas, const Vec& place) {
  Particles p;
  p.add({place, {}, 1e-3, 1000});
  std::array<Vec, 1> found;
  gas.velocity(p.place, 0, found);
  return found[0];
}

// Two cubes beside each other, centres at x = 0.5 and 1.5.
void write_two_cubes(const test::TemporaryFolder& folder) {
  const std::string mesh = "constant/polyMesh/";
  folder.write(mesh + "points",
               "12((0 0 0)(1 0 0)(2 0 0)(0 1 0)(1 1 0)(2 1 0)(0 0 1)(1 0 1)(2 0 1)(0 1 1)(1 1 1)(2 1 1))");
  folder.write(mesh + "faces",
               "11(4(1 4 10 7)4(0 6 9 3)4(0 1 7 6)4(3 9 10 4)4(0 3 4 1)4(6 7 10 9)"
               "4(2 5 11 8)4(1 2 8 7)4(4 10 11 5)4(1 4 5 2)4(7 8 11 10))");
  folder.write(mesh + "owner", "11(0 0 0 0 0 0 1 1 1 1 1)");
  folder.write(mesh + "neighbour", "1(1)");
}

TEST(SceneFrozenGas, CaseOfOpenFoamGivesItsLatestVelocity) {
  const test::TemporaryFolder folder;
  write_two_cubes(folder);
  folder.write("0/U", "dimensions [0 1 -1 0 0 0 0];\ninternalField uniform (9 9 9);\n");
  folder.write("0.5/U",
               "dimensions [0 1 -1 0 0 0 0];\ninternalField nonuniform List<vector> 2((1 0 -2)(3 0 -2));\n");
  folder.write("0.5/p", "dimensions [1 -1 -2 0 0 0 0];\ninternalField uniform 0;\n");
  const auto gas = frozen_gas_of(folder.path(), 1);
  EXPECT_NEAR(gas_at(*gas, {0.5, 0.5, 0.5}).x, 1, 1e-4);
  EXPECT_NEAR(gas_at(*gas, {1.5, 0.5, 0.5}).x, 3, 1e-4);
  EXPECT_NEAR(gas_at(*gas, {1, 0.5, 0.5}).x, 2, 1e-4);
  EXPECT_NEAR(gas_at(*gas, {1, 0.5, 0.5}).z, -2, 1e-4);
}

std::string column(const std::string& gas) {
  return "[scene]\nduration = 0.02\ntime_step = 1e-3\n[domain]\noutlets = [\"box.z_high\"]\n" + gas +
         "[effects]\ndrag = \"wen_yu\"\n[grid]\ncell = [0.0025, 0.0025, 0.0025]\n"
         "[output]\nformats = []\n"
         "[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [0.01, 0.01, 0.04]\n"
         "[[particles]]\ngroup = \"a\"\ndiameter = \"315 um\"\nnumber = 3\n";
}

TEST(SceneFrozenGas, FolderOfARunGivesTheGasThatItEndedWith) {
  const test::TemporaryFolder folder;
  Simulation simulation(parse_scene(column("[gas]\nmodel = \"coupled\"\n") +
                                        "[[gas.inlets]]\nside = \"box.z_low\"\nvelocity = [0, 0, 0.5]\n",
                                    "column"),
                        1);
  run(simulation, folder.path() / "run", silent_log(), {});
  const auto gas = frozen_gas_of(folder.path() / "run", 1);
  const auto& flow = *simulation.flow();
  for (const Vec place : {Vec{0.005, 0.005, 0.02}, {0.001, 0.009, 0.003}}) {
    std::array<Shares, 3> faces;
    for (std::size_t a = 0; a < 3; ++a) faces[a] = flow.grid().faces(place, a);
    const Vec miss = gas_at(*gas, place) - read(flow.velocity(), faces);
    EXPECT_LT(std::sqrt(dot(miss, miss)), 1e-14);  // products are summed in another order
    EXPECT_GT(gas_at(*gas, place).z, 0.1);
  }
}

TEST(SceneFrozenGas, RunWithoutAGasIsRefused) {
  const test::TemporaryFolder folder;
  Simulation simulation(parse_scene(column("[gas]\nmodel = \"uniform\"\n"), "column"), 1);
  run(simulation, folder.path() / "run", silent_log(), {});
  EXPECT_ERROR(InputError, "the run has no gas field", frozen_gas_of(folder.path() / "run", 1));
}

}  // namespace
}  // namespace elrom::scene
