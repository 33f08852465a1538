#include "foam_mesh.hpp"

#include <gmock/gmock.h>

#include <set>

#include "cell_shapes.hpp"
#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::ingest {
namespace {

/// Two hexahedra on each other: widths in x are 2 at z = 0, 4 at z = 1 and 4 at z = 2; depth 1 in y.
void write_two_cells(const test::TemporaryFolder& folder) {
  folder.write("points",
               "12((1 0 0)(3 0 0)(3 1 0)(1 1 0)(0 0 1)(4 0 1)(4 1 1)(0 1 1)(0 0 2)(4 0 2)(4 1 2)(0 1 2))");
  folder.write("faces",
               "11(4(4 5 6 7)"  // between the cells
               "4(0 3 2 1)4(0 1 5 4)4(1 2 6 5)4(2 3 7 6)4(3 0 4 7)"
               "4(8 9 10 11)4(4 5 9 8)4(5 6 10 9)4(6 7 11 10)4(7 4 8 11))");
  folder.write("owner", "11(0 0 0 0 0 0 1 1 1 1 1)");
  folder.write("neighbour", "1(1)");
}

TEST(FoamMesh, VolumesAndCentresOfAPrismAndABox) {
  const test::TemporaryFolder folder;
  write_two_cells(folder);

  const auto mesh = read_poly_mesh(folder.path());

  ASSERT_EQ(mesh.volume.size(), 2u);
  EXPECT_DOUBLE_EQ(mesh.volume[0], 3);  // trapezium of parallel sides 2 and 4, height 1
  EXPECT_DOUBLE_EQ(mesh.volume[1], 4);
  // Centroid of a trapezium: (a + 2 b) / (3 (a + b)) of its height from the side a.
  EXPECT_TRUE(mesh.centre.row(0).isApprox(Eigen::RowVector3d(2, 0.5, 10.0 / 18.0), 1e-12)) << mesh.centre;
  EXPECT_TRUE(mesh.centre.row(1).isApprox(Eigen::RowVector3d(2, 0.5, 1.5), 1e-12)) << mesh.centre;
}

TEST(FoamMesh, InsideOutCellIsRefused) {
  const test::TemporaryFolder folder;
  write_two_cells(folder);
  folder.write("points",
               "12((1 0 2)(3 0 2)(3 1 2)(1 1 2)(0 0 1)(4 0 1)(4 1 1)(0 1 1)(0 0 0)(4 0 0)(4 1 0)(0 1 0))");

  EXPECT_THAT([&] { (void)read_poly_mesh(folder.path()); },
              ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("without a positive volume")));
}

TEST(FoamMesh, PointsAndCellsOutOfRangeAreRefused) {
  const test::TemporaryFolder folder;
  write_two_cells(folder);
  folder.write("neighbour", "1(77)");
  EXPECT_THAT([&] { (void)read_poly_mesh(folder.path()); },
              ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("neighbour:1: found cell 77")));

  folder.write("faces", "1(3(0 1 99))");
  EXPECT_THAT([&] { (void)read_poly_mesh(folder.path()); },
              ::testing::ThrowsMessage<InputError>(::testing::HasSubstr("found point 99")));
}

TEST(FoamMesh, CornersOfHexahedraStandUpright) {
  const test::TemporaryFolder folder;
  write_two_cells(folder);

  const auto cells = read_poly_cells(folder.path());

  EXPECT_THAT(cells.corners, ::testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11));
  EXPECT_EQ(cells.centre, read_poly_mesh(folder.path()).centre);
}

/// A mesh of one cell. @return volume of its corners, and how many of them there are
std::pair<double, std::size_t> corners_of(const std::string& points, const std::string& faces,
                                          std::size_t n_faces) {
  const test::TemporaryFolder folder;
  std::string owner = std::to_string(n_faces) + "(";
  for (std::size_t i = 0; i < n_faces; ++i) owner += "0 ";
  folder.write("points", points);
  folder.write("faces", faces);
  folder.write("owner", owner + ")");
  folder.write("neighbour", "0()");
  const auto cells = read_poly_cells(folder.path());
  Corners corners{};
  std::copy_n(cells.corners.begin(), 8, corners.begin());
  EXPECT_GT(cells.volume[0], 0);
  return {volume_of(corners, cells.points), std::set(corners.begin(), corners.end()).size()};
}

TEST(FoamMesh, CornersOfEveryShapeEncloseItsVolume) {
  const std::string below = "((0 0 0)(1 0 0)(1 1 0)(0 1 0)";
  const auto wedge = corners_of("6(" + below.substr(1) + "(0 0 1)(0 1 1))",
                                "5(4(0 3 2 1)4(1 2 5 4)4(0 4 5 3)3(0 1 4)3(3 5 2))", 5);
  const auto pyramid =
      corners_of("5(" + below.substr(1) + "(0 0 1))", "5(4(0 3 2 1)3(0 1 4)3(1 2 4)3(2 3 4)3(3 0 4))", 5);
  const auto tetrahedron =
      corners_of("4((0 0 0)(1 0 0)(0 1 0)(0 0 1))", "4(3(0 2 1)3(0 1 3)3(1 2 3)3(2 0 3))", 4);
  // A cube whose upper front edge is cut by a point, as beside a refined region.
  const auto cut = corners_of("9(" + below.substr(1) + "(0 0 1)(1 0 1)(1 1 1)(0 1 1)(0.5 0 1))",
                              "6(4(0 3 2 1)5(4 8 5 6 7)5(0 1 5 8 4)4(1 2 6 5)4(2 3 7 6)4(3 0 4 7))", 6);

  EXPECT_DOUBLE_EQ(wedge.first, 0.5);
  EXPECT_EQ(wedge.second, 6U);
  EXPECT_DOUBLE_EQ(pyramid.first, 1.0 / 3);
  EXPECT_EQ(pyramid.second, 5U);
  EXPECT_DOUBLE_EQ(tetrahedron.first, 1.0 / 6);
  EXPECT_EQ(tetrahedron.second, 4U);
  EXPECT_DOUBLE_EQ(cut.first, 1);
  EXPECT_EQ(cut.second, 8U);
}

}  // namespace
}  // namespace elrom::ingest
