#include "elrom/model/audit.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"

namespace elrom::model {
namespace {

// Four planes of 1 m, two columns of 2 m2 and 1 m2: volumes 2 and 1 m3.
field::Mesh small_mesh() {
  field::Mesh mesh;
  mesh.n_planes = 4;
  mesh.n_columns = 2;
  mesh.centre.resize(8, 3);
  for (int plane = 0; plane < 4; ++plane)
    for (int column = 0; column < 2; ++column) {
      mesh.centre.row(plane * 2 + column) << column, 0.0, plane + 0.5;
      mesh.volume.push_back(column == 0 ? 2.0 : 1.0);
    }
  return mesh;
}

// Fields in the order volume fraction, gas velocity z, pressure, solid velocity z.
struct SmallCase {
  field::Mesh mesh = small_mesh();
  field::InputSchema schema{{{"grid_air", "kg/s", "kg/s"},
                             {"wall_air", "kg/s", "kg/s"},
                             {"solids_inventory", "kg", "t"},
                             {"gas_temperature", "K", "degC"}}};
  std::vector<double> inputs{3.0, 2.0, 3000.0, 500.0};
  std::vector<field::FieldInfo> fields{
      {.name = "solid_volume_fraction", .unit = "1", .lower = 0.0, .upper = 0.65},
      {.name = "gas_velocity_z", .unit = "m/s"},
      {.name = "pressure", .unit = "Pa"},
      {.name = "solid_velocity_z", .unit = "m/s"}};
  std::vector<float> values{0.2F, 0.1F, 0.1F, 0.1F, 0,   0,   0,   0.1F,  //
                            1,    2,    1,    1,    2,   2,   2,   1,     //
                            900,  900,  500,  500,  200, 200, 100, 130,   //
                            1,    -2,   0,    0,    1,   1,   1,   1};
  field::Furnace furnace{.name = "small",
                         .solid_density = 2000,
                         .packing_limit = 0.65,
                         .outlet_low_m = 4,
                         .openings = {{.inputs = "grid_*"}, {.inputs = "wall_*", .high_m = 1}}};
  AuditSettings settings = audit_settings(furnace);

  SmallCase() {
    settings.ambient_pressure = 100000;
    settings.gas_constant = 200;  // density 100000 / (200 * 500) = 1 kg/m3
    settings.gravity = 10;
  }
  [[nodiscard]] CaseView view() const { return {mesh, schema, inputs, fields, values}; }
};

TEST(Audit, InventoryIsVolumeFractionTimesVolumeTimesDensity) {
  const SmallCase c;

  const auto result = audit(c.view(), c.settings);

  // Plane 0: 0.2 * 2 + 0.1 = 0.5 m3, plane 1: 0.3 m3, plane 3: 0.1 m3.
  EXPECT_NEAR(*result.solids_kg, 2000 * 0.9, 1e-3);
  EXPECT_DOUBLE_EQ(*result.inventory_kg, 3000);
  // Every plane has 3 m2: weight 1800 kg * 10 / 3.
  EXPECT_NEAR(*result.solids_weight, 6000, 1e-2);
}

TEST(Audit, PlaneAveragesAreVolumeWeighted) {
  const SmallCase c;

  const auto result = audit(c.view(), c.settings);

  EXPECT_NEAR(result.planes[0].volume_fraction, 0.5 / 3, 1e-7);
  EXPECT_NEAR(result.planes[3].pressure, (2 * 100 + 130) / 3.0, 1e-4);
  EXPECT_DOUBLE_EQ(result.planes[2].height, 2.5);
  EXPECT_DOUBLE_EQ(result.planes[2].area, 3.0);
  EXPECT_NEAR(*result.pressure_drop, 900 - 110, 1e-4);
}

TEST(Audit, FlowsAreSumsOverThePlane) {
  const SmallCase c;

  const auto result = audit(c.view(), c.settings);

  // Plane 0: 1 kg/m3 * (0.8 * 1 m/s * 2 m2 + 0.9 * 2 m/s * 1 m2).
  EXPECT_NEAR(result.planes[0].gas_flow, 1.6 + 1.8, 1e-6);
  // 2000 kg/m3 * (0.2 * 1 * 2 - 0.1 * 2 * 1).
  EXPECT_NEAR(result.planes[0].solid_flow, 400, 1e-3);
}

TEST(Audit, PlanesOfPointsReachHalfwayToTheNext) {
  SmallCase c;
  c.mesh.points = c.mesh.centre;
  for (std::int32_t cell = 0; cell < 8; ++cell) c.mesh.corners.insert(c.mesh.corners.end(), 8, cell);

  const auto result = audit(c.view(), c.settings);

  EXPECT_DOUBLE_EQ(result.planes[2].area, 3.0);
  EXPECT_NEAR(result.planes[0].gas_flow, 1.6 + 1.8, 1e-6);
}

TEST(Audit, PlanesOfCellsEndAtTheirCorners) {
  SmallCase c;
  // Boxes from plane to plane + 0.6: points and corners of each cell, four below and four above.
  c.mesh.points.resize(64, 3);
  for (int cell = 0; cell < 8; ++cell)
    for (int corner = 0; corner < 8; ++corner) {
      c.mesh.points.row(8 * cell + corner) << 0, 0, cell / 2 + (corner < 4 ? 0 : 0.6);
      c.mesh.corners.push_back(8 * cell + corner);
    }

  EXPECT_NEAR(audit(c.view(), c.settings).planes[2].area, 3.0 / 0.6, 1e-12);
}

TEST(Audit, GasBalanceIsDrawnOnlyClearOfTheOpenings) {
  const SmallCase c;

  const auto result = audit(c.view(), c.settings);

  EXPECT_TRUE(std::isnan(result.planes[0].gas_inflow));  // beside the wall inlet
  EXPECT_TRUE(std::isnan(result.planes[1].gas_inflow));  // next to it
  EXPECT_DOUBLE_EQ(result.planes[2].gas_inflow, 5);
  EXPECT_TRUE(std::isnan(result.planes[3].gas_inflow));  // next to the outlet
  EXPECT_NEAR(*result.gas_balance, 6.0 / 5.0, 1e-6);
}

TEST(Audit, AnInletDisturbsThePlaneBelowItToo) {
  SmallCase c;
  c.settings.inlets = {{.inputs = "grid_*"}, {.inputs = "wall_*", .low_m = 3, .high_m = 3.5}};

  const auto result = audit(c.view(), c.settings);

  EXPECT_DOUBLE_EQ(result.planes[1].gas_inflow, 3);
  EXPECT_TRUE(std::isnan(result.planes[2].gas_inflow));
}

// The same case in two furnaces: where gas enters and how dense solids are is the furnace's to say.
TEST(Audit, FollowsTheFurnace) {
  const SmallCase c;
  auto other = c.furnace;
  other.solid_density = 1000;
  other.outlet_low_m = 10;
  other.openings[1].high_m = 0;  // beside the grid, no longer up to 1 m

  const auto first = audit(c.view(), c.settings);
  auto settings = audit_settings(other);
  settings.ambient_pressure = c.settings.ambient_pressure;
  settings.gas_constant = c.settings.gas_constant;
  const auto second = audit(c.view(), settings);

  EXPECT_NEAR(*second.solids_kg, *first.solids_kg / 2, 1e-3);
  EXPECT_TRUE(std::isnan(first.planes[1].gas_inflow));
  EXPECT_DOUBLE_EQ(second.planes[1].gas_inflow, 5);
  EXPECT_TRUE(std::isnan(first.planes[3].gas_inflow));
  EXPECT_DOUBLE_EQ(second.planes[3].gas_inflow, 5);
  EXPECT_NEAR(*first.gas_balance, 6.0 / 5, 1e-6);
  // Planes 1, 2 and 3 carry 2.7, 6 and 4.9 of 5 kg/s.
  EXPECT_NEAR(*second.gas_balance, (2.7 + 6 + 4.9) / 3 / 5, 1e-6);
}

TEST(Audit, WithoutAFurnaceThereIsNoGasBalance) {
  const SmallCase c;

  const auto result = audit(c.view(), audit_settings(std::nullopt));

  EXPECT_FALSE(result.gas_balance.has_value());
  EXPECT_TRUE(std::isnan(result.planes[2].gas_inflow));
  EXPECT_TRUE(std::isfinite(result.planes[2].gas_flow));
}

TEST(Audit, WorstPlaneAndNetSolidFlowAreOverTheBalancedPlanes) {
  SmallCase c;
  c.settings.outlet_low_m = 5;  // planes 2 and 3 are clear of the openings

  const auto result = audit(c.view(), c.settings);

  // Gas: 6 and 4.9 of 5 kg/s; solids: 0 and 2000 kg/m3 * 0.1 * 1 m/s * 1 m2.
  ASSERT_NE(result.worst_gas_plane(), nullptr);
  EXPECT_DOUBLE_EQ(result.worst_gas_plane()->height, 2.5);
  const auto solids = result.net_solid_flow();
  ASSERT_TRUE(solids.has_value());
  EXPECT_NEAR(solids->lowest, 0, 1e-9);
  EXPECT_NEAR(solids->mean, 100, 1e-3);
  EXPECT_NEAR(solids->highest, 200, 1e-3);
  EXPECT_THAT(to_text(result), testing::HasSubstr("120.0 % of the inlets' at 2.5 m (6.0 of 5.0 kg/s)"));
}

TEST(Audit, BoundsCountWhatIsOutsideAndWhatIsNotFinite) {
  SmallCase c;
  c.values[0] = 0.7F;
  c.values[1] = -0.1F;
  c.values[9] = std::nanf("");

  const auto result = audit(c.view(), c.settings);

  EXPECT_EQ(result.bounds[0].n_outside, 2u);
  EXPECT_FLOAT_EQ(static_cast<float>(result.bounds[0].highest), 0.7F);
  EXPECT_EQ(result.bounds[1].n_not_finite, 1u);
  EXPECT_FALSE(result.within_bounds());
}

TEST(Audit, SaysNothingOfWhatIsNotThere) {
  SmallCase c;
  c.fields.resize(1);
  c.values.resize(8);
  c.schema = field::InputSchema{{{"grid_air", "kg/s", "kg/s"}}};
  c.inputs.resize(1);

  const auto result = audit(c.view(), c.settings);

  EXPECT_FALSE(result.inventory_kg.has_value());
  EXPECT_FALSE(result.gas_density.has_value());
  EXPECT_FALSE(result.pressure_drop.has_value());
  EXPECT_TRUE(std::isnan(result.planes[0].gas_flow));
  EXPECT_EQ(result.worst_gas_plane(), nullptr);
  EXPECT_FALSE(result.net_solid_flow().has_value());
  EXPECT_TRUE(nlohmann::json::parse(to_json(result))["gas_balance"].is_null());
  EXPECT_THAT(to_text(result), testing::HasSubstr("inside its physical bounds"));
}

TEST(Conserve, ReachesInventoryAndGasFlow) {
  SmallCase c;
  auto values = c.values;

  const auto change = conserve(c.view(), values, {}, c.settings);

  SmallCase repaired;
  repaired.values = values;
  const auto after = audit(repaired.view(), c.settings);
  EXPECT_NEAR(*after.solids_kg, 3000, 0.01);
  EXPECT_NEAR(after.planes[2].gas_flow, 5, 1e-5);
  EXPECT_NEAR(*change.solids_kg, 1200, 1e-2);
  EXPECT_EQ(change.n_planes_balanced, 1u);
  EXPECT_TRUE(after.within_bounds());
  EXPECT_THAT(to_text(change), testing::HasSubstr("+1.20 t"));
  EXPECT_THAT(to_text(change), testing::HasSubstr("balanced in 1 planes"));
}

TEST(Conserve, NoOtherChangeThatConservesIsSmaller) {
  SmallCase c;
  c.inputs[2] = 1900;  // no bound becomes active
  const std::vector<float> scale(c.values.size(), 0.5F);
  auto values = c.values;

  conserve(c.view(), values, scale, c.settings);

  // With equal scales the smallest change spreads evenly: 100 kg over 2000 kg/m3 * 12 m3.
  for (int cell = 0; cell < 8; ++cell) EXPECT_NEAR(values[cell] - c.values[cell], 100.0 / 24000, 1e-6);
}

TEST(Conserve, ChangesNothingWhereTheBalanceHoldsAlready) {
  SmallCase c;
  c.inputs[2] = 1800;
  c.inputs[0] = 4;  // 4 + 2 kg/s = the flow in plane 2
  auto values = c.values;

  const auto change = conserve(c.view(), values, {}, c.settings);

  EXPECT_LT(change.volume_fraction_relative, 1e-6);
  EXPECT_LT(change.gas_velocity_relative, 1e-6);
}

TEST(Conserve, RefusesAnInventoryThatTheFurnaceCannotHold) {
  SmallCase c;
  c.inputs[2] = 2000 * 0.66 * 12;
  auto values = c.values;

  EXPECT_THROW(conserve(c.view(), values, {}, c.settings), NumericalError);
}

TEST(Conserve, PacksNoDenserThanTheFieldMay) {
  SmallCase c;
  c.inputs[2] = 2000 * 0.5 * 12;
  c.fields[0].upper = 0.45;  // as a furnace's packing limit sets it
  auto values = c.values;

  EXPECT_THROW(conserve(c.view(), values, {}, c.settings), NumericalError);
  c.fields[0].upper = 0.55;
  conserve(c.view(), values, {}, c.settings);
  EXPECT_LE(*std::max_element(values.begin(), values.begin() + 8), 0.55F);
}

Audit with_ratios(double solids, double gas) {
  Audit one;
  one.solids_kg = 1000 * solids;
  one.inventory_kg = 1000;
  one.gas_balance = gas;
  return one;
}

// 0.98, 1.00, 1.02 by hand: mean 1, variance 2/3 of 0.02 squared.
TEST(UsualAudit, IsMeanAndScatterOfTheCasesOwn) {
  const std::vector cases{with_ratios(0.98, 0.9), with_ratios(1, 0.9), with_ratios(1.02, 0.9)};

  const auto usual = usual_figures(cases);

  ASSERT_EQ(usual.size(), 2U);
  EXPECT_EQ(usual[0].name, "solids over inventory");
  EXPECT_NEAR(usual[0].mean, 1, 1e-12);
  EXPECT_NEAR(usual[0].deviation, 0.02 * std::sqrt(2.0 / 3), 1e-12);
  EXPECT_EQ(usual[0].n_cases, 3U);
  EXPECT_TRUE(usual_figures(std::span(cases).first(2)).empty());
}

TEST(UsualAudit, BeyondThreeDeviationsIsUnusual) {
  const std::vector<UsualFigure> usual{{"solids over inventory", 1, 0.02, 64}};

  EXPECT_TRUE(unusual_figures(with_ratios(1.059, 5), usual).empty());
  EXPECT_TRUE(unusual_figures(with_ratios(0.941, 5), usual).empty());
  EXPECT_EQ(unusual_figures(with_ratios(1.061, 5), usual),
            std::vector<std::string>{"solids over inventory is 1.06: 1.00 +- 0.02 in 64 training cases"});
  EXPECT_EQ(unusual_figures(with_ratios(0.939, 5), usual).size(), 1U);
}

TEST(UsualAudit, WithoutTrainingCasesNothingIsUnusual) {
  EXPECT_TRUE(unusual_figures(with_ratios(7, 7), {}).empty());
}

}  // namespace
}  // namespace elrom::model
