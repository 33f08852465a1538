#pragma once
// Does a point lie in the convex hull of a set of points? Distance by Gilbert, Johnson & Keerthi (1988), with
// the farthest point in a direction found through a tree of bounding boxes, so that large sets stay cheap.

#include <array>
#include <cstdint>
#include <vector>

namespace elrom::ingest {

using Point = std::array<double, 3>;

/// Thread rule: const use from any thread.
class PointHull {
 public:
  /// @param points [m], (n, 3); at least one
  explicit PointHull(std::vector<Point> points);
  /// True when the distance of `x` to the hull is at most `tolerance` [m].
  [[nodiscard]] bool contains(const Point& x, double tolerance) const;

 private:
  struct Node {
    Point low, high;
    std::size_t begin, end;
    std::int32_t left = -1, right = -1;  ///< -1: a leaf
  };
  std::int32_t build(std::size_t begin, std::size_t end);
  void farthest(std::int32_t node, const Point& direction, double& best, Point& point) const;

  std::vector<Point> points_;
  std::vector<Node> nodes_;
};

}  // namespace elrom::ingest
