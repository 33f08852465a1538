// Predictions on another mesh as the user of elrom-predict gets them, on the case that is shipped.
#include <gmock/gmock.h>

#include <filesystem>
#include <numbers>
#include <sstream>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/text.hpp"
#include "elrom/foam/foam_file.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/outcome.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::fields {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

const std::string shipped = ELROM_SOURCE_DIR "/data/formats/instants/case";

using test::Outcome;

class OntoTest : public ::testing::Test {
 protected:
  OntoTest() {
    // As the shipped case has it: 10 x 21 x 33 cells, of which these are an exact refinement.
    test::sample_bundle({.n_x = 20, .n_y = 42, .n_planes = 66, .n_submodels = 1, .n_builds = 1})
        .write(folder_ / "model.elrom");
    folder_.write("cases.csv",
                  "case,load,flow_0 [kg/s],flow_1 [kg/s],flow_2 [kg/s],flow_3 [kg/s]\n"
                  "good,0.7,7,14,21,28\nother,0.8,8,16,24,32\n");
  }
  [[nodiscard]] Outcome predict(const std::string& arguments) const {
    const std::string command = ELROM_BIN_DIR "/elrom-predict --bundle '" +
                                (folder_ / "model.elrom").string() + "' --cases '" +
                                (folder_ / "cases.csv").string() + "' " + arguments + " 2>&1";
    return test::outcome_of(command);
  }
  [[nodiscard]] std::string output(const std::string& name) const {
    return "--output '" + (folder_ / name).string() + "' ";
  }
  [[nodiscard]] std::string onto(const std::string& mesh = shipped) const { return "--onto '" + mesh + "' "; }
  /// The shipped case without its instants but one, as a case to be started.
  [[nodiscard]] fs::path copy_of_case(const std::string& name) const {
    fs::create_directories(folder_ / name);
    for (const auto* part : {"constant", "13"})
      fs::copy(fs::path(shipped) / part, folder_ / name / part, fs::copy_options::recursive);
    return folder_ / name;
  }
  [[nodiscard]] std::vector<float> predicted(const std::string& field) const {
    return io::Hdf5File::open(folder_ / "out/good.hdf").dataset("elrom/fields/" + field).read<float>();
  }

  const test::TemporaryFolder folder_;
};

/// Sum over cells of value x volume.
double integral(const ingest::CfdCase& of, std::size_t field) {
  double sum = 0;
  for (std::size_t i = 0; i < of.volume.size(); ++i)
    sum += of.volume[i] *
           static_cast<double>(of.values(static_cast<Eigen::Index>(field), static_cast<Eigen::Index>(i)));
  return sum;
}

TEST_F(OntoTest, AStartReadsBackAsWhatWasPredicted) {
  const auto outcome =
      predict("--case good --format hdf,openfoam --time 1 --parcels 30000 " + output("out") + onto());
  ASSERT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("30000 parcels in cloud kinematicCloud"));
  EXPECT_THAT(outcome.text, HasSubstr("there (+0.000 %; scaled by 1.00000)"))
      << "one mesh refines the other: nothing is lost";
  EXPECT_THAT(outcome.text, Not(HasSubstr("outside the reduced mesh")));

  // The started case: the shipped one with this as its only time folder.
  const auto started = folder_ / "started";
  fs::create_directories(started);
  fs::copy(fs::path(shipped) / "constant", started / "constant", fs::copy_options::recursive);
  fs::rename(folder_ / "out/good/1", started / "1");
  const auto found = ingest::read_openfoam(started);
  const auto mesh = field::make_furnace_mesh({}, 20, 42, 66);

  const auto fraction = predicted("solid_volume_fraction"), pressure = predicted("pressure");
  double solids = 0, pressures = 0, volume = 0;
  for (std::size_t i = 0; i < mesh.n_cells(); ++i) {
    solids += mesh.volume[i] * static_cast<double>(fraction[i]);
    pressures += mesh.volume[i] * static_cast<double>(pressure[i]);
    volume += mesh.volume[i];
  }
  EXPECT_NEAR(integral(found, 8), solids, 1e-4 * solids);
  EXPECT_NEAR(integral(found, 6) / volume, pressures / volume, 1e-4 * pressures / volume);
  // Cell by cell the cloud is right to one parcel, 30000th part of all solids.
  double worst = 0;
  for (std::size_t x = 0; x < 10; ++x) {
    double children = 0;
    for (const std::size_t child : {0, 1, 20, 21, 840, 841, 860, 861})
      children += mesh.volume[2 * x + child] * static_cast<double>(fraction[2 * x + child]);
    const auto there = static_cast<double>(found.values(8, static_cast<Eigen::Index>(x))) * found.volume[x];
    worst = std::max(worst, std::abs(there - children));
  }
  EXPECT_LT(worst, 1.001 * solids / 30000);
}

TEST_F(OntoTest, PatchesAreTheCasesOwn) {
  ASSERT_EQ(predict("--case good --format openfoam --time 1 " + output("out") + onto()).status, 0);

  foam::FoamFile before(fs::path(shipped) / "13/U.air"), after(folder_ / "out/good/1/U.air");
  before.seek_required("boundaryField");
  after.seek_required("boundaryField");
  while (!before.at_end()) ASSERT_EQ(before.token(), after.token());
  EXPECT_TRUE(after.at_end());
}

TEST_F(OntoTest, TimeFoldersThatAreThereAreLeftAloneUnlessAsked) {
  const auto into = copy_of_case("into");
  const auto pressure = test::read_bytes(into / "13/p.gz");
  const std::string arguments = "--case good --format openfoam " + output("into") + onto(into.string());

  const auto refused = predict(arguments + "--time 13");
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.text, HasSubstr("time folder is there already"));
  EXPECT_EQ(test::read_bytes(into / "13/p.gz"), pressure);

  EXPECT_EQ(predict(arguments).status, 0);
  EXPECT_TRUE(fs::exists(into / "0/U.air")) << "the case itself as output: no folder between";
  EXPECT_EQ(predict(arguments + "--time 13 --overwrite").status, 0);
  EXPECT_TRUE(fs::exists(into / "13/p"));
  EXPECT_FALSE(fs::exists(into / "13/p.gz"));
}

TEST_F(OntoTest, FluentFilesLieAtTheGivenCentresUnderTheGivenNames) {
  folder_.write("centres.csv", "x [m],y [m],z [m]\n5,13,20\n6,14,30\n");
  const auto outcome = predict(
      "--case good --format ip --fields pressure,solid_velocity_x "
      "--names solid_velocity_x=phase-2-x-velocity " +
      output("out") + onto((folder_ / "centres.csv").string()));
  ASSERT_EQ(outcome.status, 0) << outcome.text;

  EXPECT_THAT(
      base::read_text(folder_ / "out/good.ip"),
      StartsWith("3\n3\n2\n2\nphase-2-x-velocity\npressure\n(5.000000000e+00\n6.000000000e+00\n)\n(1.3"));
}

TEST_F(OntoTest, FluentValuesAreMeansOverTheGivenCells) {
  const std::string centres = ELROM_SOURCE_DIR "/data/formats/instants/averages.h5";
  const auto outcome = predict("--case good --format hdf,ip --fields gas_velocity_z,pressure " +
                               output("out") + onto(centres));
  ASSERT_EQ(outcome.status, 0) << outcome.text;

  const auto pressure = predicted("pressure");
  std::istringstream file(base::read_text(folder_ / "out/good.ip"));
  std::vector<double> last;  // of the last list in parentheses
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("(")) last.clear();
    if (const auto value = base::to_double(line.substr(line.starts_with("(") ? 1 : 0)))
      last.push_back(*value);
  }
  ASSERT_EQ(last.size(), 6930U);
  // Above the taper, where the nearest centre tells the cell: 2 x 2 x 2 equal predicted cells each.
  for (std::size_t x = 0; x < 10; ++x) {
    double sum = 0;
    for (const std::size_t child : {0, 1, 20, 21, 840, 841, 860, 861})
      sum += static_cast<double>(pressure[40 * 840 + 2 * x + child]);
    EXPECT_NEAR(last[20 * 210 + x], sum / 8, 1e-6 * std::abs(sum)) << x;
  }
}

TEST_F(OntoTest, HeadingsAndCellsOfATableMayGiveTheUnit) {
  folder_.write("m.csv", "x,y,z,volume\n5,13,20,0.5\n6,14,30,0.6\n");
  folder_.write("mm.csv", "z [cm];x [mm];y [m];volume [m3]\n2000;5000;13;0,5\n30,0m;6e3;1400,0 cm;0.6\n");
  const std::string format = "--case good --format ip --fields pressure,solid_volume_fraction ";
  ASSERT_EQ(predict(format + output("m") + onto((folder_ / "m.csv").string())).status, 0);
  const auto outcome = predict(format + output("mm") + onto((folder_ / "mm.csv").string()));
  ASSERT_EQ(outcome.status, 0) << outcome.text;

  EXPECT_EQ(base::read_text(folder_ / "mm/good.ip"), base::read_text(folder_ / "m/good.ip"));
}

TEST_F(OntoTest, CentresOutsideTheMeshAreCountedAndAllOfThemRefused) {
  folder_.write("far.csv", "x,y,z\n5,13,20\n5,13,1000\n500,13,20\n");
  for (const std::string how : {"conservative", "trilinear"}) {
    const auto outcome = predict("--case good --format ip --interpolation " + how + " " + output("out") +
                                 onto((folder_ / "far.csv").string()));
    EXPECT_EQ(outcome.status, 0) << outcome.text;
    EXPECT_THAT(outcome.text, HasSubstr("2 of 3 cells lie outside the reduced mesh: they take the nearest"));
  }
  folder_.write("mm.csv", "x,y,z\n5000,13000,20000\n6000,14000,30000\n");
  const auto refused =
      predict("--case good --format ip " + output("none") + onto((folder_ / "mm.csv").string()));
  EXPECT_EQ(refused.status, 3);
  EXPECT_THAT(refused.text, HasSubstr("no cell lies in the reduced mesh"));
  EXPECT_THAT(refused.text, HasSubstr("found centres x, y, z at 5000 to 6000, 1.3e+04 to 1.4e+04"));
  EXPECT_FALSE(fs::exists(folder_ / "none/good.ip"));
}

TEST_F(OntoTest, WhatAKilledStartLeftInTheCaseIsClearedAway) {
  const auto into = copy_of_case("into");
  const auto dead = base::trim(test::outcome_of("sh -c 'echo $$'").text);
  const auto remains = into / (".0." + dead + ".0.tmp"), others = into / (".1." + dead + ".0.tmp");
  fs::create_directories(remains / "lagrangian");
  fs::create_directories(others);

  ASSERT_EQ(predict("--case good --format openfoam " + output("into") + onto(into.string())).status, 0);

  EXPECT_FALSE(fs::exists(remains));
  EXPECT_TRUE(fs::exists(others)) << "of another time folder";
  EXPECT_TRUE(fs::exists(into / "0/U.air"));
}

TEST_F(OntoTest, TrilinearSaysWhatItChangedOfTheSolids) {
  const auto outcome = predict("--case good --format ip --interpolation trilinear " + output("out") +
                               onto(ELROM_SOURCE_DIR "/data/formats/instants/averages.h5"));
  EXPECT_EQ(outcome.status, 0);
  EXPECT_THAT(outcome.text, ::testing::ContainsRegex("solids .* m3 predicted, .* there \\([+-][0-9.]+ %\\)"));
}

TEST_F(OntoTest, MistakesAreOneLineEach) {
  const auto expect = [&](const std::string& arguments, int status, const std::string& text) {
    const auto outcome = predict(arguments + " " + output("out"));
    EXPECT_EQ(outcome.status, status) << arguments;
    EXPECT_THAT(outcome.text, HasSubstr(text));
    EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1) << outcome.text;
  };
  expect("--format openfoam", 2, "needs a case to start: --onto CASE");
  expect("--format openfoam --fields pressure " + onto(), 2, "leave out --fields");
  expect("--format openfoam --planes 0:3 " + onto(), 2, "--onto needs all cells");
  expect("--format openfoam --time now " + onto(), 2, "--time cannot be a time folder's name");
  expect("--format openfoam " + onto(folder_.path().string()), 3, "no OpenFOAM case");
  expect("--format ip " + onto("nowhere.csv"), 3, "no such file in nowhere.csv");
  expect("--format ip " + onto((folder_ / "cases.csv").string()), 3, "no column 'x'");
  expect("--format ip " + onto((folder_ / "model.elrom").string()), 3, "model.elrom");
  expect("--format csv " + onto(), 2, "--onto is for --format ip and openfoam");
  expect("--format ip --names presure=p", 2, "did you mean 'pressure'?");
  expect("--format ip --names pressure", 2, "--names cannot be read");
  expect("--format ip --names pressure=x-velocity", 2,
         "--names gives two fields one name: found 'x-velocity' for gas_velocity_x and pressure");
  expect("--format ip --names pressure=p,solid_diameter=p", 2, "found 'p' for pressure and solid_diameter");
  folder_.write("heavy.csv", "x [kg],y,z\n1,2,3\n");
  expect("--format ip " + onto((folder_ / "heavy.csv").string()), 3,
         "a unit of another dimension: found 'kg'");

  const auto damaged = copy_of_case("damaged");
  folder_.write("damaged/constant/polyMesh/owner", "3(0 0");
  fs::remove(damaged / "constant/polyMesh/owner.gz");
  expect("--format openfoam " + onto(damaged.string()), 3, "owner:1");
}

}  // namespace
}  // namespace elrom::fields
