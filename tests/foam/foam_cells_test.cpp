#include "elrom/foam/foam_cells.hpp"

#include <gmock/gmock.h>

#include "foam_box.hpp"

namespace elrom::foam {
namespace {

class FoamCellsTest : public ::testing::Test {
 protected:
  FoamCellsTest() { write_two_cells(folder_); }
  const test::TemporaryFolder folder_;
};

TEST_F(FoamCellsTest, TetrahedraFillTheirCell) {
  const auto mesh = read_poly_mesh(folder_.path());
  const FoamCells cells(mesh);

  for (std::size_t cell = 0; cell < 2; ++cell) {
    double sum = 0;
    for (const auto& tet : cells.tetrahedra(cell)) {
      sum += tet.volume;
      EXPECT_TRUE(cells.contains(cell, tet.corners.rowwise().mean())) << tet.corners;
      EXPECT_TRUE(tet.point == 1 || tet.point == 2) << "a quadrangle is two triangles";
    }
    EXPECT_NEAR(sum, mesh.volume[cell], 1e-12);
  }
}

TEST_F(FoamCellsTest, PointsAreInTheCellBelowOrAboveTheirSharedFace) {
  const auto mesh = read_poly_mesh(folder_.path());
  const FoamCells cells(mesh);

  EXPECT_TRUE(cells.contains(0, {0.6, 0.5, 0.5}));  // the slanted wall is at x = 0.5 there
  EXPECT_FALSE(cells.contains(0, {0.4, 0.5, 0.5}));
  EXPECT_FALSE(cells.contains(1, {0.6, 0.5, 0.5}));
  EXPECT_TRUE(cells.contains(1, {0.1, 0.5, 1.5}));
  EXPECT_TRUE(cells.contains(0, {2, 0.5, 1}) && cells.contains(1, {2, 0.5, 1})) << "on the face: in both";
}

}  // namespace
}  // namespace elrom::foam
