#include "cells.hpp"

#include <algorithm>
#include <numeric>

#include "elrom/base/error.hpp"

namespace elrom::fields {
namespace {

constexpr std::uint8_t vtk_hexahedron = 12;
constexpr std::size_t n_corners = 8;

bool contains(const Box& box, const field::Mesh& mesh, std::size_t row) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double x = mesh.centre(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(axis));
    if (x < box.low[axis] || x > box.high[axis]) return false;
  }
  return true;
}

/// Points that the chosen cells touch, numbered anew in their old order.
void keep_used_points(const field::Mesh& mesh, const Cells& cells, CellGeometry& geometry) {
  std::vector<std::int32_t> number(static_cast<std::size_t>(mesh.points.rows()), -1);
  for (const auto row : cells.rows) {
    const auto* corners = mesh.corners.data() + static_cast<std::size_t>(row) * n_corners;
    for (std::size_t k = 0; k < n_corners; ++k) number[static_cast<std::size_t>(corners[k])] = 0;
  }
  std::int32_t n_used = 0;
  for (std::size_t i = 0; i < number.size(); ++i) {
    if (number[i] < 0) continue;
    number[i] = n_used++;
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      geometry.points.push_back(static_cast<float>(mesh.points(static_cast<Eigen::Index>(i), axis)));
    }
  }
  for (const auto row : cells.rows) {
    const auto* corners = mesh.corners.data() + static_cast<std::size_t>(row) * n_corners;
    for (std::size_t k = 0; k < n_corners; ++k)
      geometry.connectivity.push_back(number[static_cast<std::size_t>(corners[k])]);
  }
}

}  // namespace

Cells all_cells(std::size_t n_planes, std::size_t n_columns) {
  Cells cells;
  cells.n_columns = n_columns;
  cells.planes.resize(n_planes);
  std::iota(cells.planes.begin(), cells.planes.end(), 0);
  return cells;
}

Cells choose_cells(const field::Mesh& mesh, std::vector<std::int32_t> planes, const std::optional<Box>& box) {
  Cells cells;
  cells.n_columns = mesh.n_columns;
  if (planes.empty()) {
    planes.resize(mesh.n_planes);
    std::iota(planes.begin(), planes.end(), 0);
  }
  check(planes.size() == mesh.n_planes, "cells: a mesh of the planes asked for");
  for (std::size_t i = 0; i < planes.size(); ++i) {
    const auto plane = planes[i];
    const std::size_t before = cells.cells.size(), first = i * mesh.n_columns;
    for (std::size_t column = 0; column < mesh.n_columns; ++column) {
      if (box && !contains(*box, mesh, first + column)) continue;
      cells.rows.push_back(static_cast<std::int32_t>(first + column));
      cells.cells.push_back(
          static_cast<std::int32_t>(static_cast<std::size_t>(plane) * mesh.n_columns + column));
      cells.sources.push_back(static_cast<std::int32_t>(cells.planes.size() * mesh.n_columns + column));
    }
    if (cells.cells.size() > before) cells.planes.push_back(plane);
  }
  if (cells.cells.empty()) throw UsageError("no cell lies in the chosen planes and region");
  cells.whole_planes = cells.cells.size() == cells.planes.size() * mesh.n_columns;
  if (cells.whole_planes) cells.sources.clear();
  return cells;
}

CellGeometry geometry_of(const field::Mesh& mesh, const Cells& cells) {
  CellGeometry geometry;
  for (const auto row : cells.rows) {
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      geometry.centre.push_back(static_cast<float>(mesh.centre(row, axis)));
  }
  keep_used_points(mesh, cells, geometry);
  geometry.offsets.resize(cells.size() + 1);
  for (std::size_t i = 0; i <= cells.size(); ++i)
    geometry.offsets[i] = static_cast<std::int32_t>(i * n_corners);
  geometry.types.assign(cells.size(), vtk_hexahedron);
  return geometry;
}

PlaneAverage::PlaneAverage(const field::Mesh& mesh, const Cells& cells)
    : weight_(cells.size()), heights_(cells.planes.size()) {
  std::vector<double> volume(cells.planes.size(), 0.0), moment(cells.planes.size(), 0.0);
  std::size_t plane = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto row = cells.rows[i];
    while (static_cast<std::size_t>(cells.planes[plane]) !=
           static_cast<std::size_t>(cells.cells[i]) / cells.n_columns)
      ++plane;
    plane_of_.push_back(static_cast<std::int32_t>(plane));
    volume[plane] += mesh.volume[static_cast<std::size_t>(row)];
    moment[plane] += mesh.volume[static_cast<std::size_t>(row)] * mesh.centre(row, 2);
  }
  for (std::size_t i = 0; i < cells.size(); ++i) {
    weight_[i] =
        mesh.volume[static_cast<std::size_t>(cells.rows[i])] / volume[static_cast<std::size_t>(plane_of_[i])];
  }
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

}  // namespace elrom::fields
