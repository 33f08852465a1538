#include "cell_shapes.hpp"

#include <gmock/gmock.h>

namespace elrom::ingest {
namespace {

/// Corners of a box of 1 x 2 x 3 in VTK's order.
MatrixD box() {
  MatrixD points(8, 3);
  points << 0, 0, 0, 1, 0, 0, 1, 2, 0, 0, 2, 0, 0, 0, 3, 1, 0, 3, 1, 2, 3, 0, 2, 3;
  return points;
}

TEST(CellShapes, ABoxGivenInAnyOrderIsTurnedUpright) {
  const Corners upright_box{0, 1, 2, 3, 4, 5, 6, 7};

  EXPECT_EQ(upright(upright_box, box()), upright_box);
  EXPECT_EQ(upright({6, 7, 4, 5, 2, 3, 0, 1}, box()), upright_box);  // inside out
  EXPECT_EQ(upright({0, 4, 5, 1, 3, 7, 6, 2}, box()), upright_box);  // on its side
  EXPECT_EQ(upright({5, 6, 2, 1, 4, 7, 3, 0}, box()), upright_box);
}

TEST(CellShapes, OtherShapesStayAsTheyAre) {
  const std::vector<std::int32_t> bottom{1, 0, 3}, top{4, 4, 4};
  const auto corners = corners_of(bottom, top);

  EXPECT_EQ(corners, (Corners{1, 0, 3, 3, 4, 4, 4, 4}));
  EXPECT_EQ(upright(corners, box()), corners);
  EXPECT_DOUBLE_EQ(volume_of(corners, box()), 1);
}

}  // namespace
}  // namespace elrom::ingest
