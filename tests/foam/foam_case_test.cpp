#include "elrom/foam/foam_case.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <thread>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/foam/foam_file.hpp"
#include "foam_box.hpp"
#include "support/throws.hpp"

namespace elrom::foam {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* velocity =
    "FoamFile{format ascii;class volVectorField;}\ndimensions [0 1 -1 0 0 0 0];\n"
    "internalField uniform (0 0 0);\nboundaryField { walls {type noSlip;} }\n";

class FoamCaseTest : public ::testing::Test {
 protected:
  FoamCaseTest() {
    for (const auto* name : {"constant/polyMesh", "0"}) std::filesystem::create_directories(folder_ / name);
    write_two_cells(folder_, "constant/polyMesh/");
    folder_.write("constant/transportProperties", "continuousPhase air; rho.air 0.5;");
    folder_.write("constant/kinematicCloudProperties", "constantProperties { rho0 2400; alphaMax 0.9; }");
    folder_.write("0/U.air", velocity);
    folder_.write("0/p",
                  "FoamFile{class volScalarField;}\ndimensions [0 2 -2 0 0 0 0];\ninternalField uniform 7;\n"
                  "boundaryField { outlet {type fixedValue; value $internalField;} }\n");
    folder_.write("0/k.air", "FoamFile{class volScalarField;}\ninternalField uniform 3;");
    folder_.write("0/phi.air", "FoamFile{class surfaceScalarField;}\ninternalField uniform 3;");
  }
  [[nodiscard]] std::string text(const std::string& name) const { return base::read_text(folder_ / name); }

  const test::TemporaryFolder folder_;
  std::vector<float> a_{1, 2}, b_{3, 4}, c_{5, 6}, pressure_{100, 200}, fraction_{0.25F, 0.5F};
  StartFields start_{a_, b_, c_, pressure_, {fraction_, a_, a_, b_, c_}};
};

TEST_F(FoamCaseTest, SaysWhatTheCaseCallsThings) {
  const auto found = read_foam_case(folder_.path());

  EXPECT_EQ(found.gas, "air");
  EXPECT_EQ(found.gas_density, 0.5);
  EXPECT_EQ(found.cloud, "kinematicCloud");
  EXPECT_EQ(found.solid_density, 2400);
  EXPECT_EQ(found.fields.filename(), "0");
  EXPECT_EQ(found.n_parcels, std::nullopt);
}

TEST_F(FoamCaseTest, WritesValuesUnderTheCasesOwnBoundaryConditions) {
  folder_.write("0/alpha.air", "FoamFile{class volScalarField;}\ndimensions [];\ninternalField uniform 1;");
  write_time_folder(read_foam_case(folder_.path()), folder_ / "3", start_, {}, 2400, "note");

  EXPECT_THAT(text("3/U.air"), HasSubstr("internalField nonuniform List<vector>\n2\n(\n(1 3 5)\n(2 4 6)\n)"));
  EXPECT_THAT(text("3/U.air"), HasSubstr("boundaryField { walls {type noSlip;} }"));
  EXPECT_THAT(text("3/p"), HasSubstr("2\n(\n200\n400\n)")) << "kinematic: over 0.5 kg/m3";
  EXPECT_THAT(text("3/p"), HasSubstr("value uniform 7;")) << "what $internalField stood for";
  EXPECT_THAT(text("3/alpha.air"), HasSubstr("2\n(\n0.75\n0.5\n)"));
  EXPECT_EQ(text("3/k.air"), text("0/k.air"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "3/phi.air")) << "the flux of another velocity";
}

TEST_F(FoamCaseTest, APressureInPascalStaysInPascal) {
  folder_.write("0/p",
                "FoamFile{class volScalarField;}\ndimensions [1 -1 -2 0 0 0 0];\ninternalField uniform 0;");
  std::filesystem::remove(folder_ / "constant/transportProperties");
  write_time_folder(read_foam_case(folder_.path()), folder_ / "3", start_, {}, 2400, "note");

  EXPECT_THAT(text("3/p"), HasSubstr("2\n(\n100\n200\n)"));
}

TEST_F(FoamCaseTest, ATimeFolderIsReplacedAsAWhole) {
  std::filesystem::create_directories(folder_ / "3");
  folder_.write("3/old", "x");
  write_time_folder(read_foam_case(folder_.path()), folder_ / "3", start_, {}, 2400, "note");

  EXPECT_FALSE(std::filesystem::exists(folder_ / "3/old"));
  for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
    EXPECT_THAT(entry.path().filename().string(), Not(HasSubstr("tmp")));
}

TEST_F(FoamCaseTest, WhileItIsReplacedATimeFolderIsThereWhole) {
  const auto found = read_foam_case(folder_.path());
  write_time_folder(found, folder_ / "3", start_, {}, 2400, "note");
  std::atomic<bool> ends = false;
  std::size_t n_looks = 0, n_missing = 0;
  std::jthread onlooker([&] {
    for (; !ends; ++n_looks)
      if (::access((folder_ / "3/p").c_str(), R_OK) != 0) ++n_missing;
  });
  for (int i = 0; i < 20; ++i) write_time_folder(found, folder_ / "3", start_, {}, 2400, "note");
  ends = true;
  onlooker.join();

  EXPECT_GT(n_looks, 20U);
  EXPECT_EQ(n_missing, 0U) << "of " << n_looks;
}

TEST_F(FoamCaseTest, WhatIsMissingIsSaidByFile) {
  EXPECT_ERROR(InputError, "no OpenFOAM case", read_foam_case(folder_ / "0"));

  folder_.write("constant/transportProperties", "continuousPhase air;");
  EXPECT_ERROR(InputError, "p is kinematic, and the density of its gas is not known",
               read_foam_case(folder_.path()));

  folder_.write("0/p", "dimensions [0 1 -1 0 0 0 0];");
  EXPECT_ERROR(InputError, "p:1: found other dimensions", read_foam_case(folder_.path()));

  std::filesystem::remove(folder_ / "0/U.air");
  EXPECT_ERROR(InputError, "no time folder with a gas velocity", read_foam_case(folder_.path()));

  for (const auto* phase : {"air", "steam"}) folder_.write(std::string("0/U.") + phase, velocity);
  std::filesystem::remove(folder_ / "constant/transportProperties");
  EXPECT_ERROR(InputError, "cannot tell which phase is the gas", read_foam_case(folder_.path()));
}

}  // namespace
}  // namespace elrom::foam
