#include "foam_cells.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "cell_shapes.hpp"
#include "elrom/foam/foam_mesh.hpp"

namespace elrom::ingest {
namespace {

// One cell's faces, each turned so that its corners run to the left seen from inside.
using CellFaces = std::vector<std::vector<std::int32_t>>;

// The point next to `corner` that is not of the bottom; nothing where there is none or more than one.
std::optional<std::int32_t> above(std::int32_t corner, const CellFaces& faces, std::size_t i_bottom) {
  const auto& bottom = faces[i_bottom];
  std::set<std::int32_t> found;
  for (const auto& face : faces) {
    for (std::size_t i = 0; i < face.size(); ++i) {
      if (face[i] != corner) continue;
      for (const auto next : {face[(i + 1) % face.size()], face[(i + face.size() - 1) % face.size()]})
        if (std::find(bottom.begin(), bottom.end(), next) == bottom.end()) found.insert(next);
    }
  }
  if (found.size() != 1) return std::nullopt;
  return *found.begin();
}

// The face that a hexahedron, wedge, pyramid or tetrahedron is to stand on; nothing for other shapes.
std::optional<std::size_t> bottom_of(const CellFaces& faces, std::size_t n_points) {
  std::size_t n_triangles = 0, n_quads = 0, triangle = 0, quad = 0;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    if (faces[i].size() == 3) ++n_triangles, triangle = i;
    if (faces[i].size() == 4) ++n_quads, quad = i;
  }
  if (n_triangles + n_quads != faces.size()) return std::nullopt;
  const auto is = [&](std::size_t quads, std::size_t triangles, std::size_t points) {
    return n_quads == quads && n_triangles == triangles && n_points == points;
  };
  if (is(6, 0, 8) || is(1, 4, 5)) return quad;
  if (is(3, 2, 6) || is(0, 4, 4)) return triangle;
  return std::nullopt;
}

std::optional<Corners> simple_shape(const CellFaces& faces, std::size_t n_points) {
  const auto bottom = bottom_of(faces, n_points);
  if (!bottom) return std::nullopt;
  std::vector<std::int32_t> top;
  for (const auto corner : faces[*bottom]) {
    const auto point = above(corner, faces, *bottom);
    if (!point) return std::nullopt;
    top.push_back(*point);
  }
  return corners_of(faces[*bottom], top);
}

// Other polyhedra, such as those beside a refined region, are drawn as the box around their points.
Corners box_around(const std::set<std::int32_t>& corners, const MatrixD& points, std::vector<double>& more) {
  std::array<double, 3> low{}, high{};
  for (std::size_t d = 0; d < 3; ++d) {
    low[d] = high[d] = points(*corners.begin(), static_cast<Eigen::Index>(d));
    for (const auto corner : corners) {
      low[d] = std::min(low[d], points(corner, static_cast<Eigen::Index>(d)));
      high[d] = std::max(high[d], points(corner, static_cast<Eigen::Index>(d)));
    }
  }
  Corners box{};
  const auto first = static_cast<std::int32_t>(points.rows()) + static_cast<std::int32_t>(more.size() / 3);
  for (std::size_t i = 0; i < 8; ++i) {
    box[i] = first + static_cast<std::int32_t>(i);
    const bool far_x = i % 4 == 1 || i % 4 == 2, far_y = i % 4 >= 2;
    more.insert(more.end(), {(far_x ? high : low)[0], (far_y ? high : low)[1], (i >= 4 ? high : low)[2]});
  }
  return box;
}

std::vector<CellFaces> faces_of_cells(const foam::FoamMesh& mesh) {
  std::vector<CellFaces> cells(mesh.volume.size());
  for (std::size_t i = 0; i < mesh.owner.size(); ++i) {
    const auto face = mesh.face(i);
    std::vector<std::int32_t> corners(face.begin(), face.end());
    if (i < mesh.neighbour.size()) cells[mesh.neighbour[i]].push_back(corners);
    std::reverse(corners.begin(), corners.end());
    cells[mesh.owner[i]].push_back(std::move(corners));
  }
  return cells;
}

}  // namespace

CellSet read_poly_cells(const std::filesystem::path& folder) {
  auto mesh = foam::read_poly_mesh(folder);
  CellSet cells{.centre = std::move(mesh.centre)};
  const auto& points = mesh.points;
  std::vector<double> more;  // points of boxes
  for (const auto& faces : faces_of_cells(mesh)) {
    std::set<std::int32_t> of_cell;
    for (const auto& face : faces) of_cell.insert(face.begin(), face.end());
    const auto simple = simple_shape(faces, of_cell.size());
    const auto corners = simple ? upright(*simple, points) : box_around(of_cell, points, more);
    cells.corners.insert(cells.corners.end(), corners.begin(), corners.end());
  }
  const auto n_more = static_cast<Eigen::Index>(more.size() / 3);
  cells.points.resize(points.rows() + n_more, 3);
  cells.points.topRows(points.rows()) = points;
  cells.points.bottomRows(n_more) = Eigen::Map<const MatrixD>(more.data(), n_more, 3);
  cells.volume = std::move(mesh.volume);
  return cells;
}

}  // namespace elrom::ingest
