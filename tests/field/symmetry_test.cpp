#include "elrom/field/symmetry.hpp"

#include <numeric>

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

namespace elrom::field {
namespace {

using ::testing::DoubleEq;
using ::testing::ElementsAre;

MirrorDeclaration left_right() {
  return {.name = "left-right",
          .axis = 'y',
          .swap = {{"*_left", "*_right"}},
          .complement = {"return_left_fraction"}};
}
MirrorDeclaration front_rear() {
  return {.name = "front-rear", .axis = 'x', .swap = {{"*_front_*", "*_rear_*"}}};
}

InputSchema shipped() { return read_schema(ELROM_SOURCE_DIR "/data/cases/cases.csv"); }

std::vector<double> numbered(std::size_t n) {
  std::vector<double> values(n);
  std::iota(values.begin(), values.end(), 0.01);
  return values;
}

TEST(Symmetry, LeftRightSwapsPartnersAndComplementsTheFraction) {
  const InputSchema schema({{"air", "kg/s", "kg/s"},
                            {"burner_left", "kg/s", "kg/s"},
                            {"burner_right", "kg/s", "kg/s"},
                            {"return_left_fraction", "1", "1"}});
  const auto mirror = resolve(left_right(), schema, make_furnace_mesh({}, 2, 2, 1));

  EXPECT_THAT(mirror.apply_to_inputs(std::vector<double>{1, 2, 3, 0.4}), ElementsAre(1, 3, 2, DoubleEq(0.6)));
}

TEST(Symmetry, CellsMirrorAcrossTheMiddle) {
  const auto mesh = make_furnace_mesh({}, 3, 4, 2);
  const auto y = resolve(left_right(), shipped(), mesh), x = resolve(front_rear(), shipped(), mesh);

  // Plane 1, column i = 0, j = 1 -> j = 2 or i = 2.
  EXPECT_EQ(y.cell_from[12 + 0 + 3 * 1], 12 + 0 + 3 * 2);
  EXPECT_EQ(x.cell_from[12 + 0 + 3 * 1], 12 + 2 + 3 * 1);
}

TEST(Symmetry, NormalVelocityChangesItsSign) {
  const auto mesh = make_furnace_mesh({}, 2, 2, 1);
  const auto y = resolve(left_right(), shipped(), mesh);

  EXPECT_EQ(y.field_sign(Parity::vector_y), -1);
  EXPECT_EQ(y.field_sign(Parity::vector_x), 1);
  EXPECT_EQ(y.field_sign(Parity::vector_z), 1);
  EXPECT_EQ(y.field_sign(Parity::scalar), 1);
}

TEST(Symmetry, EveryElementIsAnInvolutionOnTheShippedMesh) {
  const auto mesh = read_mesh(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.h5");
  const auto schema = shipped();
  const auto group =
      symmetry_group({resolve(left_right(), schema, mesh), resolve(front_rear(), schema, mesh)},
                     schema.size(), mesh.n_cells());

  ASSERT_EQ(group.size(), 4U);
  for (const auto& mirror : group) {
    const auto values = numbered(schema.size());
    const auto twice = mirror.apply_to_inputs(mirror.apply_to_inputs(values));
    for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(twice[i], values[i], 1e-13);
    for (std::size_t c = 0; c < mesh.n_cells(); ++c) {
      ASSERT_EQ(mirror.cell_from[static_cast<std::size_t>(mirror.cell_from[c])],
                static_cast<std::int32_t>(c));
    }
  }
}

TEST(Symmetry, GroupHoldsIdentityFirstAndBothFlipsLast) {
  const auto mesh = make_furnace_mesh({}, 2, 4, 2);
  const auto schema = shipped();
  const auto x = resolve(front_rear(), schema, mesh), y = resolve(left_right(), schema, mesh);

  const auto group = symmetry_group({y, x}, schema.size(), mesh.n_cells());

  ASSERT_EQ(group.size(), 4U);
  EXPECT_EQ(group[0].axes, "");
  EXPECT_EQ(group[3].axes, "xy");
  EXPECT_EQ(group[3].field_sign(Parity::vector_x), -1);
  EXPECT_EQ(group[3].field_sign(Parity::vector_y), -1);
  EXPECT_EQ(group[0].apply_to_inputs(numbered(26)), numbered(26));
  EXPECT_EQ(group[3].input_from[schema.index_of("secondary_front_lower_left")],
            static_cast<std::int32_t>(schema.index_of("secondary_rear_lower_right")));
  EXPECT_EQ(symmetry_group({}, 3, 5).size(), 1U);
  EXPECT_EQ(symmetry_group({x}, schema.size(), mesh.n_cells()).size(), 2U);
}

TEST(Symmetry, AMeshThatIsNotSymmetricIsRefused) {
  auto mesh = make_furnace_mesh({}, 2, 2, 1);
  mesh.centre(3, 1) += 0.01;

  EXPECT_ERROR(InputError, "the mesh is not symmetric in y", resolve(left_right(), shipped(), mesh));
}

TEST(Symmetry, DeclarationsThatFitNoInputAreRefused) {
  const auto mesh = make_furnace_mesh({}, 2, 2, 1);
  const InputSchema lonely({{"burner_left", "kg/s", "kg/s"}});

  EXPECT_ERROR(InputError, "has no partner 'burner_right'",
               resolve({.name = "m", .swap = {{"*_left", "*_right"}}}, lonely, mesh));
  EXPECT_ERROR(InputError, "no boundary condition matches",
               resolve({.name = "m", .swap = {{"*_up", "*_down"}}}, lonely, mesh));
  EXPECT_ERROR(InputError, "the same number of '*'",
               resolve({.name = "m", .swap = {{"left", "right"}}}, lonely, mesh));
  EXPECT_ERROR(InputError, "unknown boundary condition",
               resolve({.name = "m", .complement = {"share"}}, lonely, mesh));
}

}  // namespace
}  // namespace elrom::field
