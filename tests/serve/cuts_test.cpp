#include "cuts.hpp"

#include <gmock/gmock.h>

namespace elrom::serve {
namespace {

constexpr std::size_t n_x = 4, n_y = 3, n_planes = 5;
constexpr double width = 10.6, depth = 27.6, height = 47;

Cuts cuts() { return Cuts(field::make_furnace_mesh({}, n_x, n_y, n_planes)); }

double area(const CutPolygons& polygons, std::size_t u, std::size_t v) {
  double twice = 0;
  for (std::size_t i = 0; i + 1 < polygons.offsets.size(); ++i) {
    const auto begin = static_cast<std::size_t>(polygons.offsets[i]),
               end = static_cast<std::size_t>(polygons.offsets[i + 1]);
    double one = 0;
    for (auto k = begin; k < end; ++k) {
      const auto next = k + 1 < end ? k + 1 : begin;
      const auto at = [&](std::size_t point, std::size_t axis) {
        return static_cast<double>(polygons.points[3 * point + axis]);
      };
      one += at(k, u) * at(next, v) - at(next, u) * at(k, v);
    }
    twice += std::abs(one);
  }
  return twice / 2;
}

TEST(Cuts, GoThroughEachCellThatTheyMeetOnce) {
  const auto all = cuts();

  EXPECT_EQ(all.cells({.axis = 2, .at = 1.0}).size(), n_x * n_y);
  EXPECT_EQ(all.cells({.axis = 1, .at = 5.0}).size(), n_x * n_planes);
  EXPECT_EQ(all.cells({.axis = 0, .at = 5.0}).size(), n_y * n_planes);
  EXPECT_EQ(all.cells({.axis = 2, .at = 1.0}).front(), 0);
}

TEST(Cuts, CoverTheCrossSectionWithoutGapOrOverlap) {
  const auto all = cuts();
  constexpr double tolerance = 1e-4;  // of float32 points, in m2

  EXPECT_NEAR(area(all.polygons({.axis = 2, .at = 30}), 0, 1), width * depth, tolerance * width * depth);
  const double high = area(all.polygons({.axis = 1, .at = 3}), 0, 2),
               low = area(all.polygons({.axis = 1, .at = 20}), 0, 2);
  EXPECT_NEAR(high, low, tolerance * high);  // the same section everywhere along y
  EXPECT_LT(high, width * height);           // it tapers
}

TEST(Cuts, LieWhereTheyWereAskedFor) {
  const auto polygons = cuts().polygons({.axis = 0, .at = 4.25});

  for (std::size_t k = 0; k < polygons.points.size(); k += 3) EXPECT_FLOAT_EQ(polygons.points[k], 4.25F);
  EXPECT_EQ(polygons.offsets.size(), polygons.cells.size() + 1);
}

TEST(Cuts, AtEitherEndGoThroughTheOutermostCells) {
  const auto all = cuts();

  EXPECT_EQ(all.cells({.axis = 2, .at = all.low()[2]}).front(), 0);
  EXPECT_EQ(all.cells({.axis = 2, .at = all.high()[2]}).back(), static_cast<int>(n_x * n_y * n_planes) - 1);
  EXPECT_TRUE(all.meets({.axis = 2, .at = height}));
  EXPECT_FALSE(all.meets({.axis = 2, .at = 47.1}));
}

TEST(Cuts, AProfileOfHeightsIsTheHeights) {
  const auto mesh = field::make_furnace_mesh({}, n_x, n_y, n_planes);
  base::LargeArray<float> height_of(mesh.n_cells());
  for (std::size_t i = 0; i < height_of.size(); ++i)
    height_of[i] = static_cast<float>(mesh.centre(static_cast<Eigen::Index>(i), 2));
  const Cuts all(mesh);

  const ExcerptParts parts(all, {.cuts = {{.axis = 2, .at = 1.0}}, .profile = true});
  const auto chosen = parts.of(height_of, mesh.n_cells());

  ASSERT_EQ(chosen.size(), n_x * n_y + n_planes);
  for (std::size_t i = 0; i < n_planes; ++i) EXPECT_NEAR(chosen[n_x * n_y + i], all.heights()[i], 1e-4);
  EXPECT_EQ(parts.begins(), (std::vector<std::size_t>{0, n_x * n_y, n_x * n_y + n_planes}));
}

}  // namespace
}  // namespace elrom::serve
