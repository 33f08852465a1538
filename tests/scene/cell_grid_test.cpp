#include "elrom/scene/cell_grid.hpp"

#include "elrom/base/error.hpp"
#include "spheres_for_tests.hpp"
#include "support/throws.hpp"

namespace elrom::scene {
namespace {

double sum_of(const Shares& shares) {
  double sum = 0;
  for (const double weight : shares.weight) sum += weight;
  return sum;
}

TEST(SceneCellGrid, HoldsTheDomainsVolume) {
  BoxShape shape{.name = "bottom", .low = {-1, -1, 0}, .high = {1, 1, 3}};
  shape.top = {{{-2, -2}, {2, 2}}};
  const Domain domain({body_of(shape)});
  const CellGrid grid(domain, {0.1, 0.1, 0.1});
  double space = 0;
  for (std::size_t c = 0; c < grid.size(); ++c) space += grid.space(c);
  EXPECT_NEAR(space, body_of(shape).volume(), 0.005 * 28);
}

// A cube that ends in the middle of cells; rods along its edges make the grid longer.
TEST(SceneCellGrid, ACellHasTheSpaceThatLiesInside) {
  const Domain domain({test::box({}, {0.95, 0.95, 0.95}), test::box({}, {1, 0.1, 0.1}, "x"),
                       test::box({}, {0.1, 1, 0.1}, "y"), test::box({}, {0.1, 0.1, 1}, "z")});
  const CellGrid grid(domain, {0.1, 0.1, 0.1});
  const auto space = [&](std::size_t x, std::size_t y, std::size_t z) {
    return grid.space(x + 10 * (y + 10 * z)) / grid.volume();
  };
  EXPECT_NEAR(space(5, 5, 5), 1, 1e-12);
  EXPECT_NEAR(space(9, 5, 5), 0.5, 1e-12);
  EXPECT_NEAR(space(9, 5, 9), 0.25, 1e-12);
  EXPECT_NEAR(space(5, 9, 9), 0.25, 1e-12);
  EXPECT_NEAR(space(9, 9, 9), 0.125, 1e-12);
}

TEST(SceneCellGrid, SharesAreTrilinearInside) {
  const Domain domain({test::box({}, {4, 4, 4})});
  const CellGrid grid(domain, {1, 1, 1});
  const auto shares = grid.cells({1.75, 2.5, 1.5});
  double x = 0;
  for (std::size_t k = 0; k < 8; ++k)
    x += shares.weight[k] * grid.centre(static_cast<std::size_t>(shares.of[k])).x;
  EXPECT_NEAR(x, 1.75, 1e-12);
  EXPECT_NEAR(sum_of(shares), 1, 1e-12);
}

TEST(SceneCellGrid, SharesAlwaysSumToOneAndNameOpenCells) {
  const Domain domain({test::box({}, {1, 1, 1}), test::box({0.4, 0.4, 0.9}, {0.6, 0.6, 2}, "pipe")});
  const CellGrid grid(domain, {0.1, 0.1, 0.1});
  base::Random random{base::Seed(1)};
  for (int k = 0; k < 2000; ++k) {
    const Vec place{random.uniform(-0.1, 1.1), random.uniform(-0.1, 1.1), random.uniform(-0.1, 2.1)};
    const auto shares = grid.cells(place);
    EXPECT_NEAR(sum_of(shares), 1, 1e-12);
    for (std::size_t n = 0; n < 8; ++n)
      EXPECT_TRUE(shares.weight[n] == 0 || grid.is_open(static_cast<std::size_t>(shares.of[n])));
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(sum_of(grid.faces(place, a)), 1, 1e-12);
    EXPECT_TRUE(grid.is_open(grid.cell_at(place)));
  }
}

// What rests on a ledge is in no jet beside it.
TEST(SceneCellGrid, GasStandsOnWalls) {
  const Domain domain(
      {test::box({}, {0.04, 0.04, 0.04}), test::box({0.01, 0.01, -0.02}, {0.03, 0.03, 0.001}, "nozzle")});
  const CellGrid grid(domain, {0.005, 0.005, 0.005});
  std::vector<double> upwards(grid.face_count(2), 0);
  for (std::size_t f = 0; f < upwards.size(); ++f) upwards[f] = grid.is_face_open(2, f) ? 1 : 0;
  const auto speed = [&](const Shares& shares) {
    double sum = 0;
    for (std::size_t k = 0; k < 8; ++k)
      sum += shares.weight[k] * upwards[static_cast<std::size_t>(shares.of[k])];
    return sum;
  };
  const double ledge = 0.0075;  // the middle of the cells beside the nozzle
  EXPECT_NEAR(speed(grid.faces({ledge, 0.02, 0}, 2)), 0, 1e-12);
  EXPECT_NEAR(speed(grid.faces({ledge, 0.02, 0.00125}, 2)), 0.25, 1e-12);
  EXPECT_NEAR(speed(grid.faces({ledge, 0.02, 0.005}, 2)), 1, 1e-12);
  EXPECT_NEAR(speed(grid.faces({0.02, 0.02, 0}, 2)), 1, 1e-12);
  EXPECT_NEAR(speed(grid.open_faces({ledge, 0.02, 0.00125}, 2)), 1, 1e-12);
  EXPECT_DOUBLE_EQ(grid.face_volume(2, grid.face(grid.cell_at({ledge, 0.02, 0.001}), 2, -1)),
                   0.5 * grid.volume());
}

TEST(SceneCellGrid, PeriodsHaveNoEnds) {
  const Domain domain = test::periodic_cube(1);
  const CellGrid grid(domain, {0.25, 0.25, 0.25});
  EXPECT_EQ(grid.neighbour(0, 0, -1), 3);
  EXPECT_EQ(grid.face(3, 0, 1), 0u);
  EXPECT_EQ(grid.cell_at({-0.1, 0.1, 0.1}), 3u);
}

TEST(SceneCellGrid, RefusesWhatCannotBe) {
  EXPECT_ERROR(UsageError, "over all of space", CellGrid(Domain(), {1, 1, 1}));
  EXPECT_ERROR(UsageError, "too many cells",
               CellGrid(Domain({test::box({}, {1, 1, 1})}), {1e-4, 1e-4, 1e-4}));
}

}  // namespace
}  // namespace elrom::scene
