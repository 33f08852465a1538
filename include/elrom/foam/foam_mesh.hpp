#pragma once
// An OpenFOAM polyMesh, and its cells' centres and volumes by the sums that OpenFOAM itself uses.

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::foam {

struct FoamMesh {
  MatrixD centre;                                    //!< [m], (n_cells, 3)
  std::vector<double> volume;                        //!< [m3], (n_cells)
  MatrixD points;                                    //!< [m], (n_points, 3)
  std::vector<std::size_t> face_begin, face_points;  //!< corners of each face: (n_faces + 1), and all of them
  std::vector<std::size_t> owner, neighbour;         //!< cells: (n_faces), (n_inner_faces)

  [[nodiscard]] std::span<const std::size_t> face(std::size_t i) const {
    return std::span(face_points).subspan(face_begin[i], face_begin[i + 1] - face_begin[i]);
  }
};

/// @param folder constant/polyMesh with points, faces, owner and neighbour
/// @throws InputError naming file, line, found and expected; also for a cell whose volume is not positive
[[nodiscard]] FoamMesh read_poly_mesh(const std::filesystem::path& folder);

}  // namespace elrom::foam
