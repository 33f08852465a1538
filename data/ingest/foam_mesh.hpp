#pragma once
// Cell centres and volumes of an OpenFOAM polyMesh, by the sums that OpenFOAM itself uses.

#include <filesystem>
#include <vector>

#include "elrom/ingest/own_mesh.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::ingest {

struct FoamMesh {
  MatrixD centre;              //!< [m], (n_cells, 3)
  std::vector<double> volume;  //!< [m3], (n_cells)
};

/// @param folder constant/polyMesh with points, faces, owner and neighbour
/// @throws InputError naming file, line, found and expected; also for a cell whose volume is not positive
[[nodiscard]] FoamMesh read_poly_mesh(const std::filesystem::path& folder);
/// The same with corners. Polyhedra that are no hexahedron, wedge, pyramid or tetrahedron have those of the
/// box around their points.
[[nodiscard]] CellSet read_poly_cells(const std::filesystem::path& folder);

}  // namespace elrom::ingest
