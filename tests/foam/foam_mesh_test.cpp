#include "elrom/foam/foam_mesh.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "foam_box.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::foam {
namespace {

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

}  // namespace
}  // namespace elrom::foam
