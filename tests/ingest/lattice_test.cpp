#include "lattice.hpp"

#include <gmock/gmock.h>

namespace elrom::ingest {
namespace {

using ::testing::ElementsAre;

TEST(Lattice, GroupsAscendAndJoinWhatIsNear) {
  MatrixD centre(5, 3);
  centre << 0, 0, 2, 0, 0, 1, 0, 0, 2.0001, 0, 0, 1, 0, 0, 3;

  EXPECT_THAT(groups_of({0, 1, 2, 3, 4}, centre, 2, 1e-3),
              ElementsAre(ElementsAre(1, 3), ElementsAre(0, 2), ElementsAre(4)));
  EXPECT_EQ(groups_of({0, 1, 2, 3, 4}, centre, 2, 1e-5).size(), 4U);
}

TEST(Lattice, CellsBecomeBoxesThatReachHalfway) {
  CellSet cells;
  cells.centre.resize(4, 3);
  cells.centre << 1, 0, 3, 0, 0, 0, 1, 0, 0, 0, 0, 3;

  ASSERT_TRUE(become_boxes(cells, {1e-6, 1e-6, 1e-6}));

  EXPECT_THAT(cells.volume, ElementsAre(9, 9, 9, 9));  // 1 x 3, and as thick as the widest step
  EXPECT_EQ(cells.points.rows(), 3 * 2 * 3);
  const auto corner = [&](std::size_t cell, std::size_t i) -> Eigen::RowVector3d {
    return cells.points.row(cells.corners[8 * cell + i]);
  };
  EXPECT_EQ(corner(1, 0), Eigen::RowVector3d(-0.5, -1.5, -1.5));
  EXPECT_EQ(corner(1, 6), Eigen::RowVector3d(0.5, 1.5, 1.5));
  EXPECT_EQ(corner(0, 6), Eigen::RowVector3d(1.5, 1.5, 4.5));
}

TEST(Lattice, CellsThatLeaveAPlaceEmptyAreNone) {
  CellSet cells;
  cells.centre.resize(4, 3);
  cells.centre << 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 2;

  EXPECT_FALSE(become_boxes(cells, {0, 0, 0}));
  cells.centre << 0, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 1;  // as many as places, but two are at one
  EXPECT_FALSE(become_boxes(cells, {0, 0, 0}));
  EXPECT_TRUE(cells.corners.empty());
}

}  // namespace
}  // namespace elrom::ingest
