#include "elrom/foam/foam_mesh.hpp"

#include <Eigen/Geometry>
#include <algorithm>

#include "elrom/base/error.hpp"
#include "elrom/foam/foam_file.hpp"

namespace elrom::foam {
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

/// Fills in points and faces. @return geometry of the faces
std::vector<Face> read_faces(const std::filesystem::path& folder, FoamMesh& mesh) {
  FoamFile points_file(folder / "points");
  points_file.to_body();
  mesh.points = points_file.vectors();
  FoamFile file(folder / "faces");
  file.to_body();
  std::vector<Face> faces(file.list_size(0, 8));
  mesh.face_begin = {0};
  std::vector<Vector3d> corners;
  file.expect("(");
  for (auto& face : faces) {
    const auto n = file.list_size(0, 2);
    if (n < 3) file.fail("a face of " + std::to_string(n) + " points", "at least 3");
    corners.clear();
    file.expect("(");
    for (std::size_t i = 0; i < n; ++i) {
      const auto point = file.label();
      if (point >= static_cast<std::size_t>(mesh.points.rows())) {
        file.fail("point " + std::to_string(point), "below " + std::to_string(mesh.points.rows()));
      }
      mesh.face_points.push_back(point);
      corners.emplace_back(mesh.points.row(static_cast<Eigen::Index>(point)).transpose());
    }
    file.expect(")");
    mesh.face_begin.push_back(mesh.face_points.size());
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

  /// Fills in centres and volumes.
  void result(FoamMesh& mesh, const std::filesystem::path& folder) const {
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

}  // namespace

FoamMesh read_poly_mesh(const std::filesystem::path& folder) {
  FoamMesh mesh;
  const auto faces = read_faces(folder, mesh);
  mesh.owner = read_cells_of_faces(folder / "owner", faces.size(), true);
  mesh.neighbour = read_cells_of_faces(folder / "neighbour", faces.size(), false);
  const auto &owner = mesh.owner, &neighbour = mesh.neighbour;
  if (owner.empty()) throw InputError({.what = "mesh without cells", .where = folder.string()});
  std::size_t n_cells = *std::max_element(owner.begin(), owner.end()) + 1;
  if (!neighbour.empty())
    n_cells = std::max(n_cells, *std::max_element(neighbour.begin(), neighbour.end()) + 1);
  CellSums(n_cells, faces, owner, neighbour).result(mesh, folder);
  return mesh;
}

}  // namespace elrom::foam
