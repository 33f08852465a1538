#include "elrom/foam/foam_cells.hpp"

#include <Eigen/Geometry>

namespace elrom::foam {
namespace {

using Eigen::Vector3d;

Vector3d point_of(const FoamMesh& mesh, std::size_t point) {
  return mesh.points.row(static_cast<Eigen::Index>(point)).transpose();
}

}  // namespace

FoamCells::FoamCells(const FoamMesh& mesh) : mesh_(mesh), begin_(mesh.volume.size() + 1, 0) {
  const auto n_faces = mesh.owner.size();
  for (const auto cell : mesh.owner) ++begin_[cell + 1];
  for (const auto cell : mesh.neighbour) ++begin_[cell + 1];
  for (std::size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  face_.resize(begin_.back());
  auto next = begin_;
  for (std::size_t i = 0; i < n_faces; ++i) {
    face_[next[mesh.owner[i]]++] = i;
    if (i < mesh.neighbour.size()) face_[next[mesh.neighbour[i]]++] = i;
  }
  face_middle_.resize(static_cast<Eigen::Index>(n_faces), 3);
  face_normal_.resize(static_cast<Eigen::Index>(n_faces), 3);
  for (std::size_t i = 0; i < n_faces; ++i) {
    const auto corners = mesh.face(i);
    Vector3d middle = Vector3d::Zero(), normal = Vector3d::Zero();
    for (const auto point : corners) middle += point_of(mesh, point) / static_cast<double>(corners.size());
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const Vector3d a = point_of(mesh, corners[c]) - middle;
      const Vector3d b = point_of(mesh, corners[(c + 1) % corners.size()]) - middle;
      normal += 0.5 * a.cross(b);
    }
    face_middle_.row(static_cast<Eigen::Index>(i)) = middle.transpose();
    face_normal_.row(static_cast<Eigen::Index>(i)) = normal.transpose();
  }
}

std::span<const std::size_t> FoamCells::faces(std::size_t cell) const {
  return std::span(face_).subspan(begin_[cell], begin_[cell + 1] - begin_[cell]);
}

bool FoamCells::contains(std::size_t cell, const Vector3d& x) const {
  for (const auto face : faces(cell)) {
    const auto row = static_cast<Eigen::Index>(face);
    const double sign = mesh_.owner[face] == cell ? 1 : -1;
    const Vector3d normal = face_normal_.row(row).transpose();
    const double outwards = sign * (x - face_middle_.row(row).transpose()).dot(normal);
    // What lies on a face is in both cells: rounding must not leave it without one.
    if (outwards > 1e-9 * normal.norm() * std::sqrt(normal.norm())) return false;
  }
  return true;
}

std::vector<Tetrahedron> FoamCells::tetrahedra(std::size_t cell) const {
  std::vector<Tetrahedron> result;
  const Vector3d centre = mesh_.centre.row(static_cast<Eigen::Index>(cell)).transpose();
  for (const auto face : faces(cell)) {
    const auto corners = mesh_.face(face);
    for (std::size_t point = 1; point + 1 < corners.size(); ++point) {
      auto first = corners[point], second = corners[point + 1];
      if (mesh_.owner[face] != cell) std::swap(first, second);
      Tetrahedron tet{.cell = cell, .face = face, .point = point, .corners = {}, .volume = 0};
      tet.corners << centre, point_of(mesh_, corners[0]), point_of(mesh_, first), point_of(mesh_, second);
      const Vector3d a = tet.corners.col(1) - centre, b = tet.corners.col(2) - centre;
      tet.volume = a.cross(b).dot(Vector3d(tet.corners.col(3) - centre)) / 6;
      if (tet.volume > 0) result.push_back(tet);
    }
  }
  return result;
}

}  // namespace elrom::foam
