#include "elrom/model/cells.hpp"

#include <numeric>

#include "elrom/base/error.hpp"

namespace elrom::model {
namespace {

constexpr std::size_t n_corners = 8;

bool contains(const Box& box, const field::Mesh& mesh, std::size_t row) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = mesh.centre(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(axis));
    if (x < box.low[axis] || x > box.high[axis]) return false;
  }
  return true;
}

const std::int32_t* corners_of(const field::Mesh& mesh, const Cells& cells, std::size_t i) {
  return mesh.corners.data() + cells.row(i) * n_corners;
}

/// Points that the chosen cells touch, numbered anew in their old order.
io::VtkHexahedra grid_of(const field::Mesh& mesh, const Cells& cells) {
  check(mesh.corners.size() == mesh.n_cells() * n_corners, "cells: a mesh with corners");
  std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.points.rows()), -1);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto* corners = corners_of(mesh, cells, i);
    for (std::size_t k = 0; k < n_corners; ++k) number[static_cast<std::size_t>(corners[k])] = 0;
  }
  std::vector<float> points;
  std::vector<std::int32_t> connectivity;
  std::int32_t n_used = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = n_used++;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      points.push_back(static_cast<float>(mesh.points(static_cast<Eigen::Index>(i), axis)));
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto* corners = corners_of(mesh, cells, i);
    for (std::size_t k = 0; k < n_corners; ++k)
      connectivity.push_back(number[static_cast<std::size_t>(corners[k])]);
  }
  return {std::move(points), std::move(connectivity)};
}

}  // namespace

Cells::Cells(std::size_t n_planes, std::size_t n_columns)
    : planes_(field::Planes().numbers(n_planes)), mesh_planes_(n_planes), n_columns_(n_columns) {
  std::iota(mesh_planes_.begin(), mesh_planes_.end(), std::size_t{0});
}

Cells::Cells(const field::Mesh& mesh, std::size_t n_planes, const field::Planes& planes,
             const std::optional<Box>& box)
    : n_columns_(mesh.n_columns) {
  const auto asked = planes.numbers(n_planes);
  check(asked.size() == mesh.n_planes, "cells: a mesh of the planes asked for");
  std::vector<std::int32_t> places;
  for (std::size_t i = 0; i < asked.size(); ++i) {
    const std::size_t before = places.size();
    for (std::size_t column = 0; column < n_columns_; ++column) {
      if (box && !contains(*box, mesh, i * n_columns_ + column)) continue;
      places.push_back(static_cast<std::int32_t>(planes_.size() * n_columns_ + column));
    }
    if (places.size() == before) continue;
    planes_.push_back(asked[i]);
    mesh_planes_.push_back(i);
  }
  if (places.empty()) throw UsageError("no cell lies in the chosen planes and region");
  if (places.size() < planes_.size() * n_columns_) part_ = std::move(places);
}

std::int32_t Cells::number(std::size_t i) const {
  return static_cast<std::int32_t>(static_cast<std::size_t>(plane(i)) * n_columns_) + column(i);
}

std::size_t Cells::row(std::size_t i) const {
  return mesh_planes_[plane_index(i)] * n_columns_ + static_cast<std::size_t>(column(i));
}

CellGeometry geometry_of(const field::Mesh& mesh, const Cells& cells) {
  CellGeometry geometry{.centre = {}, .grid = grid_of(mesh, cells)};
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      geometry.centre.push_back(
          static_cast<float>(mesh.centre(static_cast<Eigen::Index>(cells.row(i)), axis)));
  }
  return geometry;
}

PlaneAverage::PlaneAverage(const field::Mesh& mesh, const Cells& cells)
    : weight_(cells.size()), heights_(cells.planes().size()) {
  std::vector<double> volume(heights_.size(), 0.0), moment(heights_.size(), 0.0);
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::size_t row = cells.row(i), plane = cells.plane_index(i);
    plane_of_.push_back(static_cast<std::int32_t>(plane));
    volume[plane] += mesh.volume[row];
    moment[plane] += mesh.volume[row] * mesh.centre(static_cast<Eigen::Index>(row), 2);
  }
  for (std::size_t i = 0; i < cells.size(); ++i)
    weight_[i] = mesh.volume[cells.row(i)] / volume[cells.plane_index(i)];
  for (std::size_t i = 0; i < heights_.size(); ++i) heights_[i] = static_cast<float>(moment[i] / volume[i]);
}

void PlaneAverage::apply(std::span<const float> values, std::span<float> averages) const {
  check(values.size() == weight_.size() && averages.size() == heights_.size(), "plane averages: sizes");
  std::size_t i = 0;
  for (std::size_t plane = 0; plane < averages.size(); ++plane) {
    double sum = 0;
    for (; i < values.size() && static_cast<std::size_t>(plane_of_[i]) == plane; ++i)
      sum += weight_[i] * static_cast<double>(values[i]);
    averages[plane] = static_cast<float>(sum);
  }
}

}  // namespace elrom::model
