#include "elrom/model/cells.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/mesh_part.hpp"

namespace elrom::model {
namespace {

using ::testing::ElementsAre;

field::Mesh mesh() { return field::make_furnace_mesh({}, 2, 2, 3); }
Box above(double z, double to_x = Box::infinity) {
  Box box;
  box.low[2] = z;
  box.high[0] = to_x;
  return box;
}
std::vector<std::int32_t> numbers(const Cells& cells) {
  std::vector<std::int32_t> result;
  for (std::size_t i = 0; i < cells.size(); ++i) result.push_back(cells.number(i));
  return result;
}
std::vector<std::size_t> places(const Cells& cells) {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < cells.size(); ++i) result.push_back(cells.place(i));
  return result;
}

TEST(Cells, EverythingIsTheSameWithAMeshAndWithout) {
  for (const auto& cells : {Cells(mesh(), 3), Cells(3, 4)}) {
    EXPECT_TRUE(cells.whole_planes());
    EXPECT_THAT(cells.planes(), ElementsAre(0, 1, 2));
    EXPECT_THAT(numbers(cells), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
    EXPECT_THAT(places(cells), ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11));
    EXPECT_EQ(cells.row(11), 11U);
    EXPECT_EQ(cells.plane(7), 1);
    EXPECT_EQ(cells.column(7), 3);
  }
}

TEST(Cells, GeometryAndAveragesTakeAllCellsMadeWithoutAMesh) {
  const auto furnace = mesh();
  const Cells made(3, 4), chosen(furnace, 3);

  EXPECT_EQ(geometry_of(furnace, made).centre, geometry_of(furnace, chosen).centre);
  EXPECT_EQ(geometry_of(furnace, made).grid.connectivity, geometry_of(furnace, chosen).grid.connectivity);
  EXPECT_EQ(PlaneAverage(furnace, made).heights(), PlaneAverage(furnace, chosen).heights());
  EXPECT_EQ(geometry_of(furnace, made).centre.size(), 36U);
}

TEST(Cells, ARegionKeepsPlanesAndColumnsInOrder) {
  const Cells cells(mesh(), 3, {}, above(20, 5.3));

  EXPECT_FALSE(cells.whole_planes());
  EXPECT_THAT(cells.planes(), ElementsAre(1, 2));
  EXPECT_THAT(numbers(cells), ElementsAre(4, 6, 8, 10));
  EXPECT_THAT(places(cells), ElementsAre(0, 2, 4, 6));
}

TEST(Cells, WholePlanesOfARegionKnowTheirRowsInTheMesh) {
  const Cells cells(mesh(), 3, {}, above(20));

  EXPECT_TRUE(cells.whole_planes());
  EXPECT_THAT(numbers(cells), ElementsAre(4, 5, 6, 7, 8, 9, 10, 11));
  EXPECT_EQ(cells.place(0), 0U);
  EXPECT_EQ(cells.row(0), 4U);
}

TEST(Cells, PlanesAndRegionLimitTogether) {
  EXPECT_THAT(Cells(test::mesh_part(mesh(), {0, 1}), 3, {0, 1}, above(20)).planes(), ElementsAre(1));
  EXPECT_THROW((void)Cells(test::mesh_part(mesh(), {0}), 3, {0}, above(20)), UsageError);
}

TEST(Cells, GeometryOfAPartUsesJustItsPoints) {
  const auto furnace = mesh();
  const auto part = test::mesh_part(furnace, {1});
  const Cells cells(part, 3, {1});

  const auto geometry = geometry_of(part, cells);

  EXPECT_EQ(geometry.grid.points.size(), 2U * 9 * 3);
  EXPECT_EQ(geometry.grid.connectivity.size(), 4U * 8);
  EXPECT_EQ(geometry.grid.offsets.back(), 32);
  // Every corner is the point that the mesh has there.
  for (std::size_t k = 0; k < geometry.grid.connectivity.size(); ++k) {
    const auto point = static_cast<std::size_t>(geometry.grid.connectivity[k]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_FLOAT_EQ(
          geometry.grid.points[point * 3 + axis],
          static_cast<float>(furnace.points(furnace.corners[4 * 8 + k], static_cast<Eigen::Index>(axis))));
    }
  }
}

TEST(Cells, PlaneAverageWeighsByVolume) {
  auto furnace = mesh();
  furnace.volume = {1, 3, 0.5, 0.5, 1, 1, 1, 1, 1, 1, 1, 1};
  const auto part = test::mesh_part(furnace, {0, 2});
  const Cells cells(part, 3, {0, 2});
  const PlaneAverage average(part, cells);
  const std::vector<float> values{10, 20, 2, 4, 1, 2, 3, 6};
  std::vector<float> result(2);

  average.apply(values, result);

  EXPECT_FLOAT_EQ(result[0], (10 * 1 + 20 * 3 + 2 * 0.5F + 4 * 0.5F) / 5);
  EXPECT_FLOAT_EQ(result[1], 3);
  EXPECT_NEAR(average.heights()[0], 47.0 / 6, 1e-5);
}

}  // namespace
}  // namespace elrom::model
