// --audit and --conserve as users run them: what is printed, what is in the file, what is refused.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "elrom/base/text.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/outcome.hpp"
#include "support/sample_bundle.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::fields {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double inventory_kg = 60000, solid_density = 2400;

using test::Outcome;

class PhysicsTest : public ::testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  field::Mesh mesh_;

  // The sample's networks with inputs whose names the audit knows.
  void SetUp() override {
    auto bundle = test::sample_bundle();
    bundle.info.schema = field::InputSchema({{"primary_air", "kg/s", "kg/s"},
                                             {"burner_left", "kg/s", "kg/s"},
                                             {"solids_inventory", "kg", "t"},
                                             {"gas_temperature", "K", "K"}});
    mesh_ = bundle.mesh;
    bundle.write(folder_ / "no_furnace.elrom");
    bundle.furnace = field::read_furnace(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml");
    bundle.write(folder_ / "model.elrom");
    bundle.info.usual_audit = {{"solids over inventory", 1, 0.001, 64}};
    bundle.write(folder_ / "strict.elrom");
    for (auto& opening : bundle.furnace->openings)
      if (opening.inputs == "burner_*") opening.low_m = opening.high_m = 30;
    bundle.write(folder_ / "lifted.elrom");
    test::sample_bundle().write(folder_ / "no_inventory.elrom");
  }
  [[nodiscard]] Outcome predict(const std::string& options, const std::string& bundle = "model.elrom") const {
    return run(
        "--bundle '" + (folder_ / bundle).string() +
        "' --set primary_air=7 --set burner_left=14 --set 'solids_inventory=60 t' --set gas_temperature=1100 "
        "--output '" +
        (folder_ / "out").string() + "' " + options);
  }
  [[nodiscard]] static Outcome run(const std::string& arguments) {
    return test::outcome_of(ELROM_BIN_DIR "/elrom-predict " + arguments + " 2>&1");
  }
  [[nodiscard]] io::Hdf5File result() const { return io::Hdf5File::open(folder_ / "out/case.hdf"); }
  [[nodiscard]] std::vector<float> field(const std::string& name) const {
    return result().dataset("elrom/fields/" + name).read<float>();
  }
  // Our own sum over the file's cells, beside the audit's.
  [[nodiscard]] double solids_in_file() const {
    const auto fraction = field("solid_volume_fraction");
    double mass = 0;
    for (std::size_t c = 0; c < fraction.size(); ++c) mass += solid_density * fraction[c] * mesh_.volume[c];
    return mass;
  }
};

TEST_F(PhysicsTest, AuditIsPrintedAndStored) {
  const auto outcome = predict("--audit");

  ASSERT_EQ(outcome.status, 0) << outcome.text;
  for (const char* part : {"solids inventory", "60.00 t asked for", "gas flow", "worst plane",
                           "net solid flow", "pressure drop", "bounds"})
    EXPECT_THAT(outcome.text, HasSubstr(part));
  const auto file = result();
  const auto audit = file.group("elrom/audit");
  EXPECT_NEAR(audit.number("solids_kg"), solids_in_file(), 1e-6 * solids_in_file());
  EXPECT_DOUBLE_EQ(audit.number("inventory_kg"), inventory_kg);
  EXPECT_EQ(audit.number("within_bounds"), 1);
  const auto pressure = field("pressure");
  const std::size_t top = 4 * mesh_.n_columns;
  const auto planes = audit.dataset("planes/pressure").read<double>();
  ASSERT_EQ(planes.size(), 5U);
  EXPECT_NEAR(audit.number("pressure_drop_Pa"), planes.front() - planes.back(), 1e-9);
  const auto [low, high] =
      std::minmax_element(pressure.begin() + static_cast<std::ptrdiff_t>(top), pressure.end());
  EXPECT_GE(planes.back(), *low);
  EXPECT_LE(planes.back(), *high);
  EXPECT_FALSE(file.has("elrom/conservation"));
}

TEST_F(PhysicsTest, AuditChangesNoValue) {
  ASSERT_EQ(predict("").status, 0);
  const auto plain = field("solid_volume_fraction");
  EXPECT_FALSE(result().has("elrom/audit"));

  ASSERT_EQ(predict("--audit").status, 0);

  EXPECT_EQ(field("solid_volume_fraction"), plain);
}

TEST_F(PhysicsTest, ConserveBringsSolidsAndGasToTheInputsAndReportsItsSize) {
  ASSERT_EQ(predict("").status, 0);
  const double before = solids_in_file();
  const auto velocity_x = field("gas_velocity_x");

  const auto outcome = predict("--conserve --audit");

  ASSERT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("solids added"));
  EXPECT_THAT(outcome.text, HasSubstr("balanced in 1 planes"));
  EXPECT_GT(std::abs(before - inventory_kg), 100);  // something to repair
  EXPECT_NEAR(solids_in_file(), inventory_kg, 1e-5 * inventory_kg);
  EXPECT_EQ(field("gas_velocity_x"), velocity_x);
  const auto file = result();
  const auto change = file.group("elrom/conservation");
  EXPECT_NEAR(change.number("solids_kg"), inventory_kg - before, 1e-5 * inventory_kg);
  EXPECT_GT(change.number("volume_fraction_rms"), 0);
  EXPECT_GT(change.number("gas_velocity_rms_m_per_s"), 0);
  // The audit is of what is written: only plane 2 is clear of the openings.
  EXPECT_EQ(file.group("elrom/audit").number("worst_gas_plane"), 2);
  EXPECT_NEAR(file.group("elrom/audit").number("worst_gas_balance"), 1, 1e-5);
  EXPECT_NEAR(file.dataset("elrom/audit/planes/gas_inflow").read<double>()[2], 7 + 14, 1e-12);
}

TEST_F(PhysicsTest, TextExportsSayThatTheyWereChanged) {
  ASSERT_EQ(predict("--conserve --format txt").status, 0);
  EXPECT_THAT(test::read_bytes(folder_ / "out/case.txt"), HasSubstr("# conserved: solids added"));

  ASSERT_EQ(predict("--format txt").status, 0);
  EXPECT_THAT(test::read_bytes(folder_ / "out/case.txt"), Not(HasSubstr("conserved")));
}

TEST_F(PhysicsTest, ProfilesAreOfTheRepairedCells) {
  ASSERT_EQ(predict("--conserve --audit --profile").status, 0);

  const auto profile = result().dataset("elrom/profiles/solid_volume_fraction").read<float>();
  const auto audited = result().dataset("elrom/audit/planes/volume_fraction").read<double>();
  ASSERT_EQ(profile.size(), audited.size());
  for (std::size_t p = 0; p < profile.size(); ++p) EXPECT_NEAR(profile[p], audited[p], 1e-6);
}

TEST_F(PhysicsTest, PartsOfTheFurnaceAreRefused) {
  for (const char* options :
       {"--audit --planes 1:3", "--conserve --planes 0", "--audit --region 0:5.3,:,:"}) {
    const auto outcome = predict(options);
    EXPECT_EQ(outcome.status, 2) << options;
    EXPECT_THAT(outcome.text, HasSubstr("needs all cells"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(PhysicsTest, MissingFieldsAndInputsAreRefused) {
  const auto audit = predict("--audit --fields solid_volume_fraction,gas_velocity_z,pressure");
  EXPECT_EQ(audit.status, 2);
  EXPECT_THAT(audit.text, HasSubstr("--audit needs field 'solid_velocity_z'"));
  const auto conserve = predict("--conserve --fields gas_velocity_z");
  EXPECT_EQ(conserve.status, 2);
  EXPECT_THAT(conserve.text, HasSubstr("--conserve needs field 'solid_volume_fraction'"));
  EXPECT_EQ(predict("--conserve --fields gas_velocity_z,solid_volume_fraction").status, 0);

  const auto other = run("--bundle '" + (folder_ / "no_inventory.elrom").string() +
                         "' --set flow_0=7 --set flow_1=14 --set flow_2=21 --set flow_3=28 --conserve");
  EXPECT_EQ(other.status, 2);
  EXPECT_THAT(other.text, HasSubstr("solids_inventory"));
}

TEST_F(PhysicsTest, TheBundlesFurnaceSaysWhereGasEnters) {
  ASSERT_EQ(predict("--audit").status, 0);
  const auto shipped = result().dataset("elrom/audit/planes/gas_inflow").read<double>();

  ASSERT_EQ(predict("--audit", "lifted.elrom").status, 0);

  // Planes of 9.4 m: the burners at 30 m, not at 4 to 6 m, leave plane 1 to the primary air alone.
  const auto lifted = result().dataset("elrom/audit/planes/gas_inflow").read<double>();
  EXPECT_NEAR(shipped[2], 7 + 14, 1e-12);
  EXPECT_NEAR(lifted[1], 7, 1e-12);
  EXPECT_TRUE(std::isnan(shipped[1]));
  EXPECT_TRUE(std::isnan(lifted[2]));
}

TEST_F(PhysicsTest, WithoutAFurnaceAuditAndRepairAreRefused) {
  for (const std::string option : {"--audit", "--conserve"}) {
    const auto outcome = predict(option, "no_furnace.elrom");
    EXPECT_EQ(outcome.status, 2);
    EXPECT_THAT(outcome.text, HasSubstr(option + " needs a furnace description in "));
    EXPECT_THAT(outcome.text, HasSubstr("no_furnace.elrom: found none"));
    EXPECT_EQ(std::count(outcome.text.begin(), outcome.text.end(), '\n'), 1);
  }
  EXPECT_EQ(predict("", "no_furnace.elrom").status, 0);
}

TEST_F(PhysicsTest, MoreSolidsThanTheFurnaceHoldsIsAnArithmeticError) {
  const auto outcome = predict("--conserve --set 'solids_inventory=1000000 t'");

  EXPECT_EQ(outcome.status, 5);
  EXPECT_THAT(outcome.text, HasSubstr("case case: no solid volume fraction"));
}

TEST_F(PhysicsTest, AnAuditBeyondTheTrainingCasesScatterIsAWarning) {
  const auto outcome =
      predict("--audit --summary '" + (folder_ / "summary.csv").string() + "'", "strict.elrom");

  EXPECT_EQ(outcome.status, 0) << outcome.text;
  EXPECT_THAT(outcome.text, HasSubstr("warning: 1 of 1 cases"));
  EXPECT_THAT(outcome.text, HasSubstr("1.00 +- 0.001 in 64 training cases"));
  EXPECT_THAT(result().group("elrom/audit").texts("unusual"),
              ::testing::ElementsAre(HasSubstr("solids over inventory is")));
  EXPECT_THAT(test::read_bytes(folder_ / "summary.csv"), HasSubstr("solids over inventory is"));
  // Repaired, it holds the inventory; and a bundle of before does not say what is usual.
  EXPECT_THAT(predict("--audit --conserve", "strict.elrom").text, Not(HasSubstr("unusual")));
  EXPECT_THAT(predict("--audit").text, Not(HasSubstr("unusual")));
  EXPECT_FALSE(result().group("elrom/audit").has_attribute("unusual"));
}

}  // namespace
}  // namespace elrom::fields
