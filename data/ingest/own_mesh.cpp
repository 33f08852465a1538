#include "elrom/ingest/own_mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "gradient.hpp"
#include "lattice.hpp"

namespace elrom::ingest {
namespace {

constexpr double usual_tolerance = 1e-5;  // of the extent; ascii files keep six digits and more

std::array<double, 3> tolerances(const MatrixD& centre, const Grouping& grouping) {
  std::array<double, 3> tolerance{};
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double extent = centre.col(axis).maxCoeff() - centre.col(axis).minCoeff();
    tolerance[static_cast<std::size_t>(axis)] = grouping.tolerance_m.value_or(usual_tolerance * extent);
  }
  return tolerance;
}

bool equally_many(const std::vector<Group>& groups) {
  return std::all_of(groups.begin(), groups.end(),
                     [&](const Group& group) { return group.size() == groups.front().size(); });
}

// The axes in a plane: columns run along the first, rows along the second.
std::array<int, 2> in_plane(int axis) { return {axis == 0 ? 1 : 0, axis == 2 ? 1 : 2}; }

class Planes {
 public:
  Planes(const MatrixD& centre, const Grouping& grouping)
      : centre_(centre), axis_(grouping.axis), tolerance_(tolerances(centre, grouping)) {
    Group all(static_cast<std::size_t>(centre.rows()));
    std::iota(all.begin(), all.end(), std::size_t{0});
    in_source_ = {all};
    found_ = groups_of(all, centre, axis_, tolerance_[static_cast<std::size_t>(axis_)]);
  }

  [[nodiscard]] const std::vector<Group>& found() const { return found_; }
  [[nodiscard]] const std::vector<Group>& in_source() const { return in_source_; }

  /// Columns in the order of rows, the same place in every plane. A single plane without rows stays as it is.
  [[nodiscard]] std::vector<Group> ordered() const {
    if (found_.size() == 1 && !equally_many(rows_of(found_.front()))) return in_source_;
    std::vector<Group> planes;
    for (const auto& plane : found_) planes.push_back(by_rows(plane));
    for (std::size_t i = 1; i < planes.size(); ++i)
      if (auto same = as_in(planes.front(), planes[i]); !same.empty()) planes[i] = std::move(same);
    return planes;
  }

 private:
  [[nodiscard]] std::vector<Group> rows_of(const Group& plane) const {
    const int across = in_plane(axis_)[1];
    return groups_of(plane, centre_, across, tolerance_[static_cast<std::size_t>(across)]);
  }

  [[nodiscard]] Group by_rows(const Group& plane) const {
    const int along = in_plane(axis_)[0];
    Group order;
    for (auto row : rows_of(plane)) {
      std::stable_sort(row.begin(), row.end(),
                       [&](auto a, auto b) { return place(a, along) < place(b, along); });
      order.insert(order.end(), row.begin(), row.end());
    }
    return order;
  }

  /// `plane` in the order of `first`, where its cells stand above those; else nothing.
  [[nodiscard]] Group as_in(const Group& first, const Group& plane) const {
    MatrixD flat(static_cast<Eigen::Index>(first.size()), 3);
    for (std::size_t i = 0; i < first.size(); ++i)
      flat.row(static_cast<Eigen::Index>(i)) = centre_.row(static_cast<Eigen::Index>(first[i]));
    flat.col(axis_).setZero();
    const CellCloud cloud(flat);
    constexpr auto none = std::numeric_limits<std::size_t>::max();
    Group order(first.size(), none);
    for (const auto cell : plane) {
      Point x{place(cell, 0), place(cell, 1), place(cell, 2)};
      x[static_cast<std::size_t>(axis_)] = 0;
      const auto column = static_cast<std::size_t>(cloud.nearest(x, 1).front());
      for (const int d : in_plane(axis_))
        if (std::abs(place(cell, d) - place(first[column], d)) > tolerance_[static_cast<std::size_t>(d)])
          return {};
      if (order[column] != none) return {};
      order[column] = cell;
    }
    return order;
  }

  [[nodiscard]] double place(std::size_t cell, int axis) const {
    return centre_(static_cast<Eigen::Index>(cell), axis);
  }

  const MatrixD& centre_;
  int axis_;
  std::array<double, 3> tolerance_;
  std::vector<Group> in_source_, found_;
};

std::string described(const std::vector<Group>& groups) {
  const auto [least, most] = std::minmax_element(
      groups.begin(), groups.end(), [](const Group& a, const Group& b) { return a.size() < b.size(); });
  const auto few = std::to_string(least->size()), many = std::to_string(most->size());
  return std::to_string(groups.size()) + " of " + (few == many ? few : few + " to " + many) + " cells";
}

// Planes as asked for, or as they are found.
std::vector<Group> choose(const Planes& planes, const Grouping& grouping, const std::string& where) {
  const auto& found = planes.found();
  const bool equal = equally_many(found);
  if (!grouping.n_planes) {
    const bool layered = equal && found.front().size() > 1;
    return layered ? planes.ordered() : planes.in_source();
  }
  if (*grouping.n_planes == 1 && found.size() > 1) return planes.in_source();
  if (equal && *grouping.n_planes == found.size()) return planes.ordered();
  throw InputError({.what = std::string("planes along ") + "xyz"[grouping.axis],
                    .where = where,
                    .found = described(found),
                    .expected = std::to_string(*grouping.n_planes) + " of equally many",
                    .advice = "--group-tolerance joins planes that lie near each other, --planes 1 takes all "
                              "cells as one plane"});
}

field::Mesh in_order(const CellSet& cells, const std::vector<Group>& planes) {
  field::Mesh mesh{.n_planes = planes.size(), .n_columns = planes.front().size(), .points = cells.points};
  mesh.centre.resize(cells.centre.rows(), 3);
  Eigen::Index row = 0;
  for (const auto& plane : planes) {
    for (const auto cell : plane) {
      mesh.centre.row(row++) = cells.centre.row(static_cast<Eigen::Index>(cell));
      mesh.volume.push_back(cells.volume[cell]);
      const auto* corners = cells.corners.data() + 8 * cell;
      mesh.corners.insert(mesh.corners.end(), corners, corners + 8);
    }
  }
  return mesh;
}

void become_points(CellSet& cells) {
  cells.points = cells.centre;
  for (Eigen::Index cell = 0; cell < cells.centre.rows(); ++cell)
    cells.corners.insert(cells.corners.end(), 8, static_cast<std::int32_t>(cell));
}

}  // namespace

OwnMesh group_into_planes(CellSet cells, const Grouping& grouping, const std::string& where) {
  if (cells.centre.rows() == 0) throw InputError({.what = "mesh without cells", .where = where});
  OwnMesh result;
  if (cells.corners.empty()) {
    result.has_corners = become_boxes(cells, tolerances(cells.centre, grouping));
    if (!result.has_corners) become_points(cells);
  }
  result.has_volumes = !cells.volume.empty();
  if (!result.has_volumes) cells.volume.assign(static_cast<std::size_t>(cells.centre.rows()), 1);
  const Planes planes(cells.centre, grouping);
  const auto chosen = choose(planes, grouping, where);
  result.layered = chosen.size() == planes.found().size();
  result.mesh = in_order(cells, chosen);
  return result;
}

}  // namespace elrom::ingest
