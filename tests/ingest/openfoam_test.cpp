#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "hdf5_values.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::ingest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

const std::string sample = ELROM_SOURCE_DIR "/data/formats/instants/";

/// The sample's case, read once.
const CfdCase& instants() {
  static const CfdCase result = read_openfoam(sample + "case");
  return result;
}

std::vector<float> expected(const std::string& dataset) {
  return testing::hdf5_values(sample + "averages.h5", dataset);
}

double largest(const std::vector<float>& values) {
  double most = 0;
  for (const float value : values) most = std::max(most, std::abs(static_cast<double>(value)));
  return most;
}

// The given averages were made in double from the same seven-digit texts and stored as floats.
constexpr double tolerance = 2e-6;  // of the field's largest value

TEST(OpenFoam, AveragesAreThoseGivenWithTheInstants) {
  const auto& found = instants();
  const auto fraction = expected("/fields/solid_volume_fraction");

  for (std::size_t f = 0; f < found.fields.size(); ++f) {
    const auto& name = found.fields[f].name;
    const auto values = expected("/fields/" + name);
    ASSERT_EQ(values.size(), static_cast<std::size_t>(found.values.cols()));
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (name == "solid_diameter" && fraction[i] == 0) continue;  // d50 there; its own test
      ASSERT_NEAR(found.values(static_cast<Eigen::Index>(f), static_cast<Eigen::Index>(i)), values[i],
                  tolerance * largest(values))
          << name << " cell " << i;
    }
  }
}

TEST(OpenFoam, CellsWithoutParcelsHoldGasVelocityAndAMedianDiameter) {
  const auto& found = instants();
  const auto fraction = expected("/fields/solid_volume_fraction");
  const auto empty =
      static_cast<Eigen::Index>(std::find(fraction.begin(), fraction.end(), 0.f) - fraction.begin());
  ASSERT_LT(empty, found.values.cols());

  EXPECT_EQ(found.values(0, empty), found.values(3, empty));
  EXPECT_EQ(found.values(2, empty), found.values(5, empty));
  // The run's d50, 375.266 um, is an input of the case; the
  // parcels' median estimates it from a finite sample.
  EXPECT_NEAR(found.values(7, empty), 375.266e-6, 0.05 * 375.266e-6);
}

TEST(OpenFoam, MeshIsTheOneOfTheAverages) {
  const auto& found = instants();
  const auto centre = expected("/mesh/centre");
  const auto volume = expected("/mesh/volume");

  for (std::size_t i = 0; i < volume.size(); ++i) {
    ASSERT_NEAR(found.volume[i], volume[i], 1e-5 * volume[i]) << "cell " << i;
    const auto row = static_cast<Eigen::Index>(i);
    ASSERT_NEAR(found.centre(row, 1), centre[3 * i + 1], 2e-5);
    // The averages' file has the middle of the cell's height; the centroid of a cell that leans and widens
    // with height lies up to 2 % of the cell's size (0.5 to 1.4 m) away from it.
    ASSERT_NEAR(found.centre(row, 0), centre[3 * i], 0.01);
    ASSERT_NEAR(found.centre(row, 2), centre[3 * i + 2], 0.025);
  }
  EXPECT_EQ(found.record.inputs.name, "case");
  EXPECT_DOUBLE_EQ(found.record.averaging_window_s, 2.5);
}

/// A copy of the sample that a test may damage.
class CaseCopy {
 public:
  CaseCopy() { std::filesystem::copy(sample + "case", path(), std::filesystem::copy_options::recursive); }
  [[nodiscard]] std::filesystem::path path() const { return folder_.path() / "case"; }
  void replace(const std::string& name, const std::string& text) const {
    std::filesystem::remove(path() / (name + ".gz"));
    folder_.write("case/" + name, text);
  }

 private:
  test::TemporaryFolder folder_;
};

TEST(OpenFoam, DamagedCasesAreRefusedByFile) {
  const auto message = [](const std::string& name, const std::string& text) {
    const CaseCopy copy;
    copy.replace(name, text);
    try {
      (void)read_openfoam(copy.path());
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  const std::string cloud = "10.5/lagrangian/kinematicCloud/";

  EXPECT_THAT(message(cloud + "d", "3(1e-4 1e-4 1e-4)"),
              AllOf(HasSubstr(cloud + "d:1"), HasSubstr("a list of 3")));
  EXPECT_THAT(message(cloud + "nParticle", "10004{-1}"), HasSubstr("expected positive values"));
  EXPECT_THAT(message("10.5/p", "internalField nonuniform List<scalar> 2(1 2);"),
              HasSubstr("expected 6930 entries"));
  EXPECT_THAT(message(cloud + "coordinates", "1((0.1 0.1 0.1 0.7) 99999 0 1)"), HasSubstr("cell 99999"));
  EXPECT_THAT(message("constant/transportProperties", "continuousPhase gas;"),
              HasSubstr("no entry 'rho.gas'"));
}

TEST(OpenFoam, InstantWithoutItsCloudIsRefused) {
  const CaseCopy copy;
  std::filesystem::remove_all(copy.path() / "10.5" / "lagrangian");

  EXPECT_THAT([&] { (void)read_openfoam(copy.path()); },
              ThrowsMessage<InputError>(HasSubstr("found 0 clouds")));
}

TEST(OpenFoam, PositionsServeWhereCoordinatesAreMissing) {
  const test::TemporaryFolder folder;
  // One cubic cell of 1 m3, one parcel of 6 / pi particles of 0.1 m: parcel volume 0.001 m3.
  folder.write("constant/polyMesh/points", "8((0 0 0)(1 0 0)(1 1 0)(0 1 0)(0 0 1)(1 0 1)(1 1 1)(0 1 1))");
  folder.write("constant/polyMesh/faces", "6(4(0 3 2 1)4(4 5 6 7)4(0 1 5 4)4(1 2 6 5)4(2 3 7 6)4(3 0 4 7))");
  folder.write("constant/polyMesh/owner", "6(0 0 0 0 0 0)");
  folder.write("constant/polyMesh/neighbour", "0()");
  folder.write("constant/transportProperties", "continuousPhase gas; rho.gas 2;");
  folder.write("0.5/U.gas", "internalField uniform (1 2 3);");
  folder.write("0.5/p", "internalField uniform 7;");
  const std::string cloud = "0.5/lagrangian/sand/";
  folder.write(cloud + "positions", "1((0.5 0.5 0.5) 0)");
  folder.write(cloud + "U", "1((4 5 6))");
  folder.write(cloud + "d", "1(0.1)");
  folder.write(cloud + "nParticle", "1(1.909859317102744)");
  folder.write(cloud + "rho", "1{2400}");

  const auto found = read_openfoam(folder.path());

  const std::vector<float> values(found.values.data(), found.values.data() + 9);
  EXPECT_THAT(values,
              ::testing::Pointwise(::testing::FloatEq(), {4.f, 5.f, 6.f, 1.f, 2.f, 3.f, 14.f, 0.1f, 0.001f}));
}

}  // namespace
}  // namespace elrom::ingest
