#include "point_hull.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "elrom/base/error.hpp"

namespace elrom::ingest {

namespace {

double dot(const Point& a, const Point& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Point minus(const Point& a, const Point& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

struct Nearest {
  Point point{};
  double square = std::numeric_limits<double>::infinity();
  std::vector<Point> corners;  ///< of the part of the simplex that holds it
};

// Point nearest to the origin on the plane (line, point) through `corners`, if it lies between them.
void try_part(const std::vector<Point>& corners, Nearest& best) {
  const auto n = static_cast<Eigen::Index>(corners.size());
  Eigen::MatrixXd gram(n - 1, n - 1);
  Eigen::VectorXd right(n - 1);
  std::vector<Point> edges;
  for (std::size_t i = 1; i < corners.size(); ++i) edges.push_back(minus(corners[i], corners[0]));
  for (Eigen::Index i = 0; i + 1 < n; ++i) {
    right[i] = -dot(edges[static_cast<std::size_t>(i)], corners[0]);
    for (Eigen::Index j = 0; j + 1 < n; ++j)
      gram(i, j) = dot(edges[static_cast<std::size_t>(i)], edges[static_cast<std::size_t>(j)]);
  }
  Eigen::VectorXd share = Eigen::VectorXd::Zero(n - 1);
  if (n > 1) {
    const Eigen::FullPivLU<Eigen::MatrixXd> solver(gram);
    if (!solver.isInvertible()) return;  // a flat part; its own parts are tried too
    share = solver.solve(right);
  }
  constexpr double slack = -1e-12;
  if (n > 1 && (share.minCoeff() < slack || share.sum() > 1 - slack)) return;
  Point point = corners[0];
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t d = 0; d < 3; ++d) point[d] += share[static_cast<Eigen::Index>(i)] * edges[i][d];
  }
  const double square = dot(point, point);
  if (square < best.square) best = {point, square, corners};
}

// Nearest point of a simplex of up to four corners: every one of its parts is tried.
Nearest nearest_of(const std::vector<Point>& simplex) {
  Nearest best;
  for (unsigned part = 1; part < (1U << simplex.size()); ++part) {
    std::vector<Point> corners;
    for (std::size_t i = 0; i < simplex.size(); ++i) {
      if ((part >> i & 1U) != 0) corners.push_back(simplex[i]);
    }
    try_part(corners, best);
  }
  return best;
}

}  // namespace

PointHull::PointHull(std::vector<Point> points) : points_(std::move(points)) {
  check(!points_.empty(), "the hull of no points");
  build(0, points_.size());
}

std::int32_t PointHull::build(std::size_t begin, std::size_t end) {
  constexpr std::size_t leaf_size = 64;
  Node node{points_[begin], points_[begin], begin, end};
  for (std::size_t i = begin; i < end; ++i) {
    for (std::size_t d = 0; d < 3; ++d) {
      node.low[d] = std::min(node.low[d], points_[i][d]);
      node.high[d] = std::max(node.high[d], points_[i][d]);
    }
  }
  const auto id = static_cast<std::int32_t>(nodes_.size());
  nodes_.push_back(node);
  if (end - begin <= leaf_size) return id;
  const auto size = minus(node.high, node.low);
  const auto axis = static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
  const auto middle = begin + (end - begin) / 2;
  const auto at = [&](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end),
                   [axis](const Point& a, const Point& b) { return a[axis] < b[axis]; });
  const auto left = build(begin, middle), right = build(middle, end);
  nodes_[static_cast<std::size_t>(id)].left = left;
  nodes_[static_cast<std::size_t>(id)].right = right;
  return id;
}

void PointHull::farthest(std::int32_t id, const Point& direction, double& best, Point& point) const {
  const auto& node = nodes_[static_cast<std::size_t>(id)];
  double bound = 0;
  for (std::size_t d = 0; d < 3; ++d)
    bound += std::max(direction[d] * node.low[d], direction[d] * node.high[d]);
  if (bound <= best) return;
  if (node.left >= 0) {
    farthest(node.left, direction, best, point);
    farthest(node.right, direction, best, point);
    return;
  }
  for (std::size_t i = node.begin; i < node.end; ++i) {
    const double reach = dot(direction, points_[i]);
    if (reach <= best) continue;
    best = reach;
    point = points_[i];
  }
}

bool PointHull::contains(const Point& x, double tolerance) const {
  std::vector<Point> simplex{minus(points_.front(), x)};
  constexpr int most_steps = 64;
  for (int step = 0; step < most_steps; ++step) {
    const auto nearest = nearest_of(simplex);
    if (nearest.square <= tolerance * tolerance) return true;
    const Point towards{-nearest.point[0], -nearest.point[1], -nearest.point[2]};
    double best = -std::numeric_limits<double>::infinity();
    Point far{};
    farthest(0, towards, best, far);
    const auto corner = minus(far, x);
    // A plane through the nearest point that no point of the set passes: x lies outside.
    const double progress = nearest.square - dot(nearest.point, corner);
    if (progress <= tolerance * std::sqrt(nearest.square)) return false;
    simplex = nearest.corners;
    simplex.push_back(corner);
  }
  return false;
}

}  // namespace elrom::ingest
