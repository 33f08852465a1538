// Faults planted into shipped cases, on the CFD's own mesh; bench-door does the same at full size.

#include "physics_checks.hpp"

#include <gmock/gmock.h>

#include "elrom/ingest/check.hpp"
#include "elrom/ingest/onto_mesh.hpp"
#include "support/planted_faults.hpp"

namespace elrom::ingest {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const field::Furnace& furnace() {
  static const auto one = field::read_furnace(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml");
  return one;
}

/// A dozen shipped cases of all loads.
const std::vector<CfdCase>& shipped_set() {
  static const auto cases = [] {
    std::vector<CfdCase> result;
    for (const auto* name : {"train_000", "train_001", "train_002", "train_007", "train_015", "train_018",
                             "train_031", "train_047", "train_050", "load_042", "load_098", "rep1_064"})
      result.push_back(read_el3d(std::string(ELROM_SOURCE_DIR "/data/cases/") + name + ".h5"));
    return result;
  }();
  return cases;
}

void add(Checker& checker, const CfdCase& one, const field::Furnace* of = &furnace()) {
  const auto layers = layers_of(one);
  checker.add(view_of(one, layers ? &*layers : nullptr, of));
}

/// Findings on a case that replaces the third.
std::vector<Finding> among_others(const CfdCase& one) {
  Checker checker;
  for (std::size_t i = 0; i < shipped_set().size(); ++i) add(checker, i == 2 ? one : shipped_set()[i]);
  return findings_on(checker.findings(), one.record.inputs.name);
}

std::vector<Finding> alone(const CfdCase& one) {
  Checker checker;
  add(checker, one);
  return findings_on(checker.findings(), one.record.inputs.name);
}

/// On a mesh as fine as the CFD's, as import brings it.
void add_on_mesh(Checker& checker, const CfdCase& one) {
  static const auto mesh = field::make_furnace_mesh({}, 10, 21, 33);
  OntoMesh onto_mesh(mesh, 1);
  const auto snapshot = onto_mesh.bring(one, one.schema, one.fields);
  checker.add(view_of(snapshot.record, snapshot.fields, mesh, one.schema, one.fields, &furnace(),
                      onto_mesh.coverage()));
}

CfdCase with_fault(const std::string& kind, std::size_t variant = 0) {
  auto one = shipped_set()[2];
  for (const auto& fault : test::planted_faults())
    if (fault.kind == kind) fault.plant(one, variant);
  return one;
}

auto of_kind(const std::string& kind) { return Contains(Field(&Finding::kind, kind)); }

TEST(PhysicsChecks, ShippedCasesRaiseNoAlarmTogetherOrAlone) {
  EXPECT_THAT(among_others(shipped_set()[2]), IsEmpty());
  for (const auto& one : shipped_set())
    for (const auto& finding : alone(one)) ADD_FAILURE() << line_of(finding);
}

TEST(PhysicsChecks, AStoresFirstCaseIsJudgedByPhysics) {
  EXPECT_THAT(alone(with_fault("gas_z_reversed")), AllOf(of_kind("flow_direction"), of_kind("gas_balance")));
  EXPECT_THAT(alone(with_fault("solid_z_reversed")), of_kind("flow_direction"));
  EXPECT_THAT(alone(with_fault("pressure_reversed")), of_kind("flow_direction"));
  EXPECT_THAT(alone(with_fault("fraction_inverted")), of_kind("solids_inventory"));
  EXPECT_THAT(alone(with_fault("inventory_off", 1)), Not(IsEmpty()));
  for (std::size_t field = 0; field < 9; ++field)
    EXPECT_THAT(alone(with_fault("cells_shuffled", field)), of_kind("roughness")) << field;
}

auto about(const std::string& kind, const std::string& quantity, const std::string& what) {
  return Contains(AllOf(Field(&Finding::kind, kind), Field(&Finding::quantity, quantity),
                        Field(&Finding::severity, Severity::wrong),
                        Field(&Finding::message, HasSubstr(what))));
}

TEST(PhysicsChecks, AFieldOfOneValueIsEmptyAlsoAsTheFirstCase) {
  EXPECT_THAT(alone(with_fault("solid_z_constant")),
              about("empty_field", "solid_velocity_z", "is 0, plausible from"));
  auto one = shipped_set()[2];
  one.values.row(test::row_of(one, "pressure")).setConstant(101325.1F);
  EXPECT_THAT(alone(one), about("empty_field", "pressure", "scatter of pressure"));
}

TEST(PhysicsChecks, VelocitiesThatCopyAnotherAreFoundAsTheyAreOrAsALine) {
  for (std::size_t variant = 0; variant < 3; ++variant)
    for (const std::string axis : {"x", "y", "z"})
      EXPECT_THAT(
          alone(with_fault("solid_copies_gas", variant)),
          about("empty_field", "gas_velocity_" + axis, "solid_velocity_" + axis + " does not explain"))
          << variant;
}

TEST(PhysicsChecks, VelocitiesWhoseAxesChangedPlacesBreakContinuity) {
  EXPECT_THAT(alone(with_fault("axes_exchanged")), about("continuity", "", "plausible from 0.2"));
  auto one = shipped_set()[2];
  test::scale_field(one, "gas_velocity_x", -1);
  test::scale_field(one, "gas_velocity_y", -1);
  EXPECT_THAT(alone(one), of_kind("continuity"));
}

// Columns that lean, as in the furnace's taper, meet other gas above.
TEST(PhysicsChecks, ContinuityIsReadAcrossLeaningColumns) {
  auto mesh = field::make_furnace_mesh({.bottom_width_m = 5.3, .taper_height_m = 47}, 10, 10, 12);
  CfdCase one{
      .record = {}, .schema = {}, .centre = mesh.centre, .volume = mesh.volume, .fields = {}, .values = {}};
  one.values.resize(3, mesh.centre.rows());
  for (Eigen::Index f = 0; f < 3; ++f)
    one.fields.push_back(field::field_info("gas_velocity_" + std::string(1, "xyz"[f])));
  // u = x^2 y, v = 0, w = -2 x y z: divergence-free.
  for (Eigen::Index i = 0; i < one.values.cols(); ++i) {
    const auto x = mesh.centre(i, 0), y = mesh.centre(i, 1), z = mesh.centre(i, 2);
    one.values.col(i) << static_cast<float>(x * x * y), 0.0F, static_cast<float>(-2 * x * y * z);
  }
  for (const auto& reading : read_continuity({.one = view_of(one, &mesh), .audit = {}}))
    EXPECT_GT(reading.value, 0.99);
}

TEST(PhysicsChecks, KinematicPressureIsMoreThanTheSolidsWeigh) {
  EXPECT_THAT(alone(with_fault("pressure_kinematic")), about("solids_inventory", "pressure", "0.25 to 1.2"));
}

TEST(PhysicsChecks, AFifthOfTheSolidsMissingIsWrong) {
  EXPECT_THAT(alone(with_fault("fraction_low")),
              about("solids_inventory", "solid_volume_fraction", "0.85 to 1.12"));
}

TEST(PhysicsChecks, MissingCellsAreMissingVolume) {
  for (std::size_t variant = 0; variant < 3; ++variant) {
    Checker checker;
    add_on_mesh(checker, with_fault("cells_missing", variant));
    EXPECT_THAT(checker.findings(), about("mesh_cover", "", "volume of the CFD's cells")) << variant;
  }
}

// Where an export has no volumes, what the other cases lose in resampling tells.
TEST(PhysicsChecks, MissingCellsAreLostInResampling) {
  Checker checker;
  for (std::size_t i = 0; i < shipped_set().size(); ++i) {
    auto one = i == 2 ? with_fault("cells_missing") : shipped_set()[i];
    one.volume.clear();
    add_on_mesh(checker, one);
  }
  EXPECT_THAT(
      findings_on(checker.findings(), shipped_set()[2].record.inputs.name),
      Contains(AllOf(Field(&Finding::kind, "mesh_cover"), Field(&Finding::severity, Severity::suspicious),
                     Field(&Finding::message, HasSubstr("error of resampling")))));
}

TEST(PhysicsChecks, AnInstantIsRougherThanAverages) {
  for (std::size_t variant = 0; variant < 6; ++variant)
    EXPECT_THAT(among_others(with_fault("instant", variant)), of_kind("roughness")) << variant;
}

TEST(PhysicsChecks, AnInletThatChangedPlacesWithThePrimaryAirBreaksTheBalance) {
  for (std::size_t other = 0; other < 20; ++other)
    EXPECT_THAT(alone(with_fault("inlets_exchanged", other)), of_kind("gas_balance")) << other;
}

TEST(PhysicsChecks, OneFaultAmongOthersIsFoundByItsCheck) {
  EXPECT_THAT(among_others(with_fault("inventory_off", 1)), Not(IsEmpty()));
  EXPECT_THAT(among_others(with_fault("gas_off", 0)), Not(IsEmpty()));
  EXPECT_THAT(among_others(with_fault("beyond_bounds")), of_kind("out_of_bounds"));
}

/// Cases of one reading each.
std::vector<CaseSummary> with_readings(const std::vector<double>& values) {
  std::vector<CaseSummary> cases;
  for (const double value : values) {
    CaseSummary one;
    one.readings = {{.check = "solids_inventory",
                     .quantity = "solid_volume_fraction",
                     .what = "solids over the inventory",
                     .value = value,
                     .low = 0.7,
                     .high = 1.3,
                     .least_spread = 0.02}};
    cases.push_back(one);
  }
  return cases;
}

std::vector<double> usual_values(std::size_t n) {
  std::vector<double> values;
  for (std::size_t i = 0; i < n; ++i) values.push_back(0.99 + 0.01 * static_cast<double>(i % 3));
  return values;
}

TEST(PhysicsChecks, AReadingIsComparedWithTheOtherCases) {
  auto values = usual_values(20);
  values.push_back(0.71);

  const auto found = judge_physics(with_readings(values));

  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].i_case, 20U);
  EXPECT_FALSE(found[0].impossible);
  EXPECT_NEAR(found[0].low, 1 - 7 * 2 * 0.02, 1e-12);
  EXPECT_EQ(in_words(found[0]), "solids over the inventory is 0.71, in 20 other cases 0.72 to 1.28");
}

TEST(PhysicsChecks, FewCasesAreJudgedByPhysicsAlone) {
  auto values = usual_values(7);
  values.push_back(0.75);
  EXPECT_THAT(judge_physics(with_readings(values)), IsEmpty());
  values.back() = 0.65;

  const auto found = judge_physics(with_readings(values));

  ASSERT_EQ(found.size(), 1U);
  EXPECT_TRUE(found[0].impossible);
  EXPECT_EQ(in_words(found[0]), "solids over the inventory is 0.65, plausible 0.7 to 1.3");
}

TEST(PhysicsChecks, OddCasesInTheStoreDoNotHideEachOther) {
  auto values = usual_values(21);
  values.insert(values.end(), {1.28, 1.27, 1.28});

  const auto found = judge_physics(with_readings(values));

  ASSERT_EQ(found.size(), 3U);
  EXPECT_EQ(found[0].i_case, 21U);
}

// Of another problem than a furnace nobody knows where gas goes.
TEST(PhysicsChecks, WithoutADescriptionNoDirectionIsWrong) {
  Checker checker;
  add(checker, with_fault("gas_z_reversed"), nullptr);

  const auto found = findings_on(checker.findings(), shipped_set()[2].record.inputs.name);

  EXPECT_THAT(found, Not(of_kind("flow_direction")));
  EXPECT_THAT(found, Not(of_kind("gas_balance")));
}

TEST(PhysicsChecks, LayersAreFoundWhereTheExportHasThem) {
  const auto layers = layers_of(shipped_set()[0]);
  ASSERT_TRUE(layers);
  EXPECT_EQ(layers->n_planes, 33U);
  EXPECT_EQ(layers->n_columns, 210U);

  auto mixed = shipped_set()[0];
  mixed.centre.row(5).swap(mixed.centre.row(5000));
  EXPECT_FALSE(layers_of(mixed));
}

TEST(PhysicsChecks, EveryKindOfFindingCanBeAccepted) {
  for (const auto& one : shipped_set()) {
    const auto layers = layers_of(one);
    for (const auto& reading : read_physics(view_of(one, &*layers, &furnace())))
      EXPECT_THAT(finding_kinds(), Contains(reading.check));
  }
}

}  // namespace
}  // namespace elrom::ingest
