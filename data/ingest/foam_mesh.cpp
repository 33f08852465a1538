#include "foam_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <optional>
#include <set>

#include "cell_shapes.hpp"
#include "elrom/base/error.hpp"
#include "foam_file.hpp"

namespace elrom::ingest {
namespace {

using Eigen::Vector3d;

struct Face {
  Vector3d centre, area;  //!< [m]; outward from the owner, length = area [m2]
};

// A polygon is split into triangles about the mean of its corners; the centre is weighted by their areas.
Face face_geometry(const std::vector<Vector3d>& corners) {
  const auto n = corners.size();
  Vector3d middle = Vector3d::Zero();
  for (const auto& corner : corners) middle += corner;
  middle /= static_cast<double>(n);
  Vector3d twice_area = Vector3d::Zero(), moment = Vector3d::Zero();
  double weight = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const auto& a = corners[i];
    const auto& b = corners[(i + 1) % n];
    const Vector3d normal = (b - a).cross(middle - a);
    const double size = normal.norm();
    twice_area += normal;
    weight += size;
    moment += size * (a + b + middle);
  }
  return {weight > 0 ? Vector3d(moment / (3 * weight)) : middle, 0.5 * twice_area};
}

struct Faces {
  MatrixD points;  //!< [m]
  std::vector<Face> geometry;
  std::vector<std::size_t> begin{0};  //!< corners of each face in `corner`
  std::vector<std::int32_t> corner;

  [[nodiscard]] std::size_t size() const { return geometry.size(); }
  [[nodiscard]] std::span<const std::int32_t> corners_of(std::size_t face) const {
    return std::span(corner).subspan(begin[face], begin[face + 1] - begin[face]);
  }
};

Faces read_faces(const std::filesystem::path& folder) {
  FoamFile points_file(folder / "points");
  points_file.to_body();
  Faces faces{.points = points_file.vectors()};
  const auto& points = faces.points;
  FoamFile file(folder / "faces");
  file.to_body();
  faces.geometry.resize(file.list_size(0, 8));
  std::vector<Vector3d> corners;
  file.expect("(");
  for (auto& face : faces.geometry) {
    const auto n = file.list_size(0, 2);
    if (n < 3) file.fail("a face of " + std::to_string(n) + " points", "at least 3");
    corners.clear();
    file.expect("(");
    for (std::size_t i = 0; i < n; ++i) {
      const auto point = file.label();
      if (point >= static_cast<std::size_t>(points.rows())) {
        file.fail("point " + std::to_string(point), "below " + std::to_string(points.rows()));
      }
      corners.emplace_back(points.row(static_cast<Eigen::Index>(point)).transpose());
      faces.corner.push_back(static_cast<std::int32_t>(point));
    }
    faces.begin.push_back(faces.corner.size());
    file.expect(")");
    face = face_geometry(corners);
  }
  file.expect(")");
  return faces;
}

// Pyramids from every face to an estimate of the cell's centre; their volumes weigh their centroids.
class CellSums {
 public:
  CellSums(std::size_t n_cells, const std::vector<Face>& faces, const std::vector<std::size_t>& owner,
           const std::vector<std::size_t>& neighbour)
      : estimate_(n_cells, Vector3d::Zero()), moment_(n_cells, Vector3d::Zero()), volume3_(n_cells, 0) {
    std::vector<int> n_faces(n_cells, 0);
    const auto count = [&](std::size_t cell, const Face& face) {
      estimate_[cell] += face.centre;
      ++n_faces[cell];
    };
    for (std::size_t i = 0; i < owner.size(); ++i) count(owner[i], faces[i]);
    for (std::size_t i = 0; i < neighbour.size(); ++i) count(neighbour[i], faces[i]);
    for (std::size_t i = 0; i < n_cells; ++i) estimate_[i] /= std::max(1, n_faces[i]);
    for (std::size_t i = 0; i < owner.size(); ++i) add(owner[i], faces[i], 1);
    for (std::size_t i = 0; i < neighbour.size(); ++i) add(neighbour[i], faces[i], -1);
  }

  [[nodiscard]] FoamMesh result(const std::filesystem::path& folder) const {
    FoamMesh mesh;
    mesh.centre.resize(static_cast<Eigen::Index>(estimate_.size()), 3);
    mesh.volume.resize(estimate_.size());
    for (std::size_t i = 0; i < estimate_.size(); ++i) {
      if (!(volume3_[i] > 0)) {
        throw InputError(
            {.what = "cell without a positive volume",
             .where = folder.string(),
             .found = "cell " + std::to_string(i) + " of " + std::to_string(volume3_[i] / 3) + " m3"});
      }
      mesh.centre.row(static_cast<Eigen::Index>(i)) = (moment_[i] / volume3_[i]).transpose();
      mesh.volume[i] = volume3_[i] / 3;
    }
    return mesh;
  }

 private:
  void add(std::size_t cell, const Face& face, double sign) {
    const double volume3 = sign * face.area.dot(face.centre - estimate_[cell]);
    moment_[cell] += volume3 * (0.75 * face.centre + 0.25 * estimate_[cell]);
    volume3_[cell] += volume3;
  }

  std::vector<Vector3d> estimate_, moment_;
  std::vector<double> volume3_;  //!< three times the volume
};

std::vector<std::size_t> read_cells_of_faces(const std::filesystem::path& path, std::size_t n_faces,
                                             bool all) {
  FoamFile file(path);
  file.to_body();
  auto cells = file.labels(all ? n_faces : 0);
  if (cells.size() > n_faces) file.fail(std::to_string(cells.size()) + " entries", "at most one a face");
  for (const auto cell : cells) {
    if (cell >= n_faces) file.fail("cell " + std::to_string(cell), "fewer cells than faces");
  }
  return cells;
}

// Faces, and the cells on their two sides.
struct Topology {
  Faces faces;
  std::vector<std::size_t> owner, neighbour;
  std::size_t n_cells = 0;
};

Topology read_topology(const std::filesystem::path& folder) {
  Topology mesh{.faces = read_faces(folder)};
  mesh.owner = read_cells_of_faces(folder / "owner", mesh.faces.size(), true);
  mesh.neighbour = read_cells_of_faces(folder / "neighbour", mesh.faces.size(), false);
  if (mesh.owner.empty()) throw InputError({.what = "mesh without cells", .where = folder.string()});
  mesh.n_cells = *std::max_element(mesh.owner.begin(), mesh.owner.end()) + 1;
  if (!mesh.neighbour.empty())
    mesh.n_cells =
        std::max(mesh.n_cells, *std::max_element(mesh.neighbour.begin(), mesh.neighbour.end()) + 1);
  return mesh;
}

FoamMesh geometry_of(const Topology& mesh, const std::filesystem::path& folder) {
  return CellSums(mesh.n_cells, mesh.faces.geometry, mesh.owner, mesh.neighbour).result(folder);
}

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

std::vector<CellFaces> faces_of_cells(const Topology& mesh) {
  std::vector<CellFaces> cells(mesh.n_cells);
  for (std::size_t i = 0; i < mesh.owner.size(); ++i) {
    const auto corners = mesh.faces.corners_of(i);
    cells[mesh.owner[i]].emplace_back(corners.rbegin(), corners.rend());
    if (i < mesh.neighbour.size()) cells[mesh.neighbour[i]].emplace_back(corners.begin(), corners.end());
  }
  return cells;
}

}  // namespace

FoamMesh read_poly_mesh(const std::filesystem::path& folder) {
  return geometry_of(read_topology(folder), folder);
}

CellSet read_poly_cells(const std::filesystem::path& folder) {
  auto mesh = read_topology(folder);
  auto geometry = geometry_of(mesh, folder);
  CellSet cells{.centre = std::move(geometry.centre), .volume = std::move(geometry.volume)};
  const auto& points = mesh.faces.points;
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
  return cells;
}

}  // namespace elrom::ingest
