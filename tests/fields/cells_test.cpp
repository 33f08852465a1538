#include "cells.hpp"

#include <gmock/gmock.h>

#include <numeric>

#include "elrom/base/error.hpp"
#include "support/mesh_part.hpp"

namespace elrom::fields {
namespace {

using ::testing::ElementsAre;

field::Mesh mesh() { return field::make_furnace_mesh({}, 2, 2, 3); }

TEST(Cells, EverythingIsChosenWithoutALimit) {
  const auto cells = choose_cells(mesh(), {}, {});

  EXPECT_TRUE(cells.whole_planes);
  EXPECT_EQ(cells.size(), 12U);
  EXPECT_THAT(cells.planes, ElementsAre(0, 1, 2));
}

TEST(Cells, ARegionKeepsPlanesAndColumnsInOrder) {
  const auto furnace = mesh();

  const auto cells = choose_cells(furnace, {}, parse_box(":5.3,:,20:"));

  EXPECT_FALSE(cells.whole_planes);
  EXPECT_THAT(cells.planes, ElementsAre(1, 2));
  EXPECT_THAT(cells.cells, ElementsAre(4, 6, 8, 10));
  EXPECT_THAT(cells.sources, ElementsAre(0, 2, 4, 6));
}

TEST(Cells, PlanesAndRegionLimitTogether) {
  EXPECT_THAT(choose_cells(test::mesh_part(mesh(), {0, 1}), {0, 1}, parse_box(":,:,20:")).planes,
              ElementsAre(1));
  EXPECT_THROW((void)choose_cells(test::mesh_part(mesh(), {0}), {0}, parse_box(":,:,20:")), UsageError);
}

TEST(Cells, GeometryOfAPartUsesJustItsPoints) {
  const auto furnace = mesh();
  const auto part = test::mesh_part(furnace, {1});
  const auto cells = choose_cells(part, {1}, {});

  const auto geometry = geometry_of(part, cells);

  EXPECT_EQ(geometry.points.size(), 2U * 9 * 3);
  EXPECT_EQ(geometry.connectivity.size(), 4U * 8);
  EXPECT_EQ(geometry.offsets.back(), 32);
  // Every corner is the point that the mesh has there.
  for (std::size_t k = 0; k < geometry.connectivity.size(); ++k) {
    const auto point = static_cast<std::size_t>(geometry.connectivity[k]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_FLOAT_EQ(
          geometry.points[point * 3 + axis],
          static_cast<float>(furnace.points(furnace.corners[4 * 8 + k], static_cast<Eigen::Index>(axis))));
    }
  }
}

TEST(Cells, PlaneAverageWeighsByVolume) {
  auto furnace = mesh();
  furnace.volume = {1, 3, 0.5, 0.5, 1, 1, 1, 1, 1, 1, 1, 1};
  const auto part = test::mesh_part(furnace, {0, 2});
  const auto cells = choose_cells(part, {0, 2}, {});
  const PlaneAverage average(part, cells);
  const std::vector<float> values{10, 20, 2, 4, 1, 2, 3, 6};
  std::vector<float> result(2);

  average.apply(values, result);

  EXPECT_FLOAT_EQ(result[0], (10 * 1 + 20 * 3 + 2 * 0.5F + 4 * 0.5F) / 5);
  EXPECT_FLOAT_EQ(result[1], 3);
  EXPECT_NEAR(average.heights()[0], 47.0 / 6, 1e-5);
}

}  // namespace
}  // namespace elrom::fields
