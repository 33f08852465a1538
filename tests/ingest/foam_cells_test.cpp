#include "foam_cells.hpp"

#include <gmock/gmock.h>

#include <set>

#include "cell_shapes.hpp"
#include "elrom/foam/foam_mesh.hpp"
#include "foam/foam_box.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::ingest {
namespace {

TEST(FoamCells, CornersOfHexahedraStandUpright) {
  const test::TemporaryFolder folder;
  foam::write_two_cells(folder);

  const auto cells = read_poly_cells(folder.path());

  EXPECT_THAT(cells.corners, ::testing::ElementsAre(0, 1, 2, 3, 4, 5, 6, 7, 4, 5, 6, 7, 8, 9, 10, 11));
  EXPECT_EQ(cells.centre, foam::read_poly_mesh(folder.path()).centre);
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

TEST(FoamCells, CornersOfEveryShapeEncloseItsVolume) {
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
