#include "cuts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace elrom::serve {
namespace {

constexpr std::size_t n_corners = 8;
/// Of a hexahedron in VTK order.
constexpr std::array<std::array<std::size_t, 2>, 12> edges{
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}}};

using Point = std::array<double, 3>;

/// Around their centre, seen along `axis`.
void sort_around(std::vector<Point>& points, std::size_t axis) {
  const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
  double centre_u = 0, centre_v = 0;
  for (const auto& point : points) {
    centre_u += point[u] / static_cast<double>(points.size());
    centre_v += point[v] / static_cast<double>(points.size());
  }
  std::ranges::sort(points, {},
                    [&](const Point& point) { return std::atan2(point[v] - centre_v, point[u] - centre_u); });
}

}  // namespace

Cuts::Cuts(field::Mesh mesh)
    : mesh_(std::move(mesh)), average_(mesh_, model::Cells(mesh_.n_planes, mesh_.n_columns)) {
  for (std::size_t axis = 0; axis < low_.size(); ++axis) {
    auto& lows = cell_low_[axis];
    auto& highs = cell_high_[axis];
    for (std::int32_t cell = 0; cell < static_cast<std::int32_t>(mesh_.n_cells()); ++cell) {
      double low = coordinate(cell, 0, axis), high = low;
      for (std::size_t corner = 1; corner < n_corners; ++corner) {
        low = std::min(low, coordinate(cell, corner, axis));
        high = std::max(high, coordinate(cell, corner, axis));
      }
      lows.push_back(low);
      highs.push_back(high);
    }
    low_[axis] = *std::ranges::min_element(lows);
    high_[axis] = *std::ranges::max_element(highs);
  }
}

double Cuts::coordinate(std::int32_t cell, std::size_t corner, std::size_t axis) const {
  const auto point = mesh_.corners[static_cast<std::size_t>(cell) * n_corners + corner];
  return mesh_.points(point, static_cast<Eigen::Index>(axis));
}

/// At the far end a cut goes through the last cells.
double Cuts::within(const Cut& cut) const {
  return std::min(cut.at, std::nextafter(high_[cut.axis], low_[cut.axis]));
}

std::vector<std::int32_t> Cuts::cells(const Cut& cut) const {
  const double at = within(cut);
  const auto& lows = cell_low_[cut.axis];
  const auto& highs = cell_high_[cut.axis];
  std::vector<std::int32_t> met;
  for (std::size_t cell = 0; cell < lows.size(); ++cell)
    if (lows[cell] <= at && at < highs[cell]) met.push_back(static_cast<std::int32_t>(cell));
  return met;
}

void Cuts::add_polygon(std::int32_t cell, std::size_t axis, double at, CutPolygons& polygons) const {
  std::vector<Point> points;
  for (const auto& [a, b] : edges) {
    const double from = coordinate(cell, a, axis), to = coordinate(cell, b, axis);
    if ((from <= at) == (to <= at)) continue;
    const double share = (at - from) / (to - from);
    Point point;
    for (std::size_t i = 0; i < point.size(); ++i)
      point[i] = (1 - share) * coordinate(cell, a, i) + share * coordinate(cell, b, i);
    points.push_back(point);
  }
  sort_around(points, axis);
  for (const auto& point : points)
    for (const double x : point) polygons.points.push_back(static_cast<float>(x));
  polygons.offsets.push_back(static_cast<std::int32_t>(polygons.points.size() / 3));
}

CutPolygons Cuts::polygons(const Cut& cut) const {
  CutPolygons polygons{.cells = cells(cut), .offsets = {0}, .points = {}};
  for (const auto cell : polygons.cells) add_polygon(cell, cut.axis, within(cut), polygons);
  return polygons;
}

ExcerptParts::ExcerptParts(const Cuts& cuts, const Excerpt& excerpt)
    : cuts_(cuts), profile_(excerpt.profile) {
  for (const auto& cut : excerpt.cuts) {
    cells_.push_back(cuts.cells(cut));
    begins_.push_back(begins_.back() + cells_.back().size());
  }
  if (profile_) begins_.push_back(begins_.back() + cuts.heights().size());
}

base::LargeArray<float> ExcerptParts::of(const base::LargeArray<float>& all, std::size_t n_cells) const {
  base::LargeArray<float> chosen(all.size() / n_cells * n_values());
  float* at = chosen.data();
  for (std::size_t begin = 0; begin < all.size(); begin += n_cells) {
    const auto field = std::span(all).subspan(begin, n_cells);
    for (const auto& cells : cells_)
      for (const auto cell : cells) *at++ = field[static_cast<std::size_t>(cell)];
    if (!profile_) continue;
    cuts_.profile(field, std::span(at, cuts_.heights().size()));
    at += cuts_.heights().size();
  }
  return chosen;
}

}  // namespace elrom::serve
