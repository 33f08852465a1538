#include "point_hull.hpp"

#include <gmock/gmock.h>

#include "elrom/base/random.hpp"

namespace elrom::ingest {
namespace {

// The ball is the oracle: a dense set of points on the unit sphere has nearly the ball as its hull.
TEST(PointHull, OfAFineSphereIsTheBall) {
  base::Random random{base::Seed(1)};
  std::vector<Point> sphere;
  while (sphere.size() < 20'000) {
    const Point p{random.normal(), random.normal(), random.normal()};
    const double r = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    sphere.push_back({p[0] / r, p[1] / r, p[2] / r});
  }
  const PointHull hull(sphere);

  for (int i = 0; i < 300; ++i) {
    const auto& p = sphere[static_cast<std::size_t>(i)];
    EXPECT_TRUE(hull.contains({0.98 * p[1], 0.98 * p[2], 0.98 * p[0]}, 1e-9));
    EXPECT_FALSE(hull.contains({1.001 * p[1], 1.001 * p[2], 1.001 * p[0]}, 1e-9));
  }
}

TEST(PointHull, OfABoxIncludesItsFacesEdgesAndCorners) {
  std::vector<Point> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i % 2 * 2.0, i / 2 % 2 * 3.0, i / 4 * 5.0});
  const PointHull hull(corners);

  EXPECT_TRUE(hull.contains({1, 1, 1}, 1e-9));
  EXPECT_TRUE(hull.contains({0, 1, 1}, 1e-9));
  EXPECT_TRUE(hull.contains({0, 0, 2.5}, 1e-9));
  EXPECT_TRUE(hull.contains({2, 3, 5}, 1e-9));
  EXPECT_FALSE(hull.contains({-1e-6, 1, 1}, 1e-9));
  EXPECT_FALSE(hull.contains({2.1, 3.1, 5.1}, 1e-9));
}

TEST(PointHull, OfFlatAndSinglePointSetsIsTheSetItself) {
  const PointHull triangle({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  const PointHull single({{1, 2, 3}});

  EXPECT_TRUE(triangle.contains({0.3, 0.3, 0}, 1e-9));
  EXPECT_FALSE(triangle.contains({0.3, 0.3, 1e-3}, 1e-9));
  EXPECT_FALSE(triangle.contains({0.7, 0.7, 0}, 1e-9));
  EXPECT_TRUE(single.contains({1, 2, 3}, 1e-9));
  EXPECT_FALSE(single.contains({1, 2, 3.1}, 1e-9));
}

}  // namespace
}  // namespace elrom::ingest
