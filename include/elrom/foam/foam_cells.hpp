#pragma once
// The cells of a polyMesh as bodies: is a point in one, and the tetrahedra that OpenFOAM splits one into.
//
// OpenFOAM places a particle by the tetrahedron that it is in: cell, face, and the number of the face's
// corner behind its base point, which for faces that are not badly warped is the face's first corner. The
// tetrahedron's corners are the cell's centre, the base point and two neighbouring corners of the face
// (tetIndices::faceTriIs); where the face points into the cell, those two change places.
//
// Thread rule: const use from any thread.

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "elrom/foam/foam_mesh.hpp"

namespace elrom::foam {

struct Tetrahedron {
  std::size_t cell, face, point;        ///< as in a cloud's `coordinates`
  Eigen::Matrix<double, 3, 4> corners;  ///< [m]; weights of a place refer to these, in this order
  double volume;                        ///< [m3]
};

class FoamCells {
 public:
  /// @param mesh kept by reference
  explicit FoamCells(const FoamMesh& mesh);

  /// Whether `x` [m] lies on the inner side of all of the cell's faces, each taken as flat.
  [[nodiscard]] bool contains(std::size_t cell, const Eigen::Vector3d& x) const;
  /// Without those that have no volume.
  [[nodiscard]] std::vector<Tetrahedron> tetrahedra(std::size_t cell) const;

 private:
  [[nodiscard]] std::span<const std::size_t> faces(std::size_t cell) const;

  const FoamMesh& mesh_;
  std::vector<std::size_t> begin_, face_;  //!< faces of each cell
  MatrixD face_middle_, face_normal_;      //!< mean of corners [m]; area [m2], out of the owner
};

}  // namespace elrom::foam
