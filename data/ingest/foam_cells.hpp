#pragma once
// Cells of an OpenFOAM polyMesh with their corners.

#include <filesystem>

#include "elrom/ingest/own_mesh.hpp"

namespace elrom::ingest {

/// Polyhedra that are no hexahedron, wedge, pyramid or tetrahedron get the corners of the box around their
/// points. @param folder with points, faces, owner and neighbour @throws InputError
[[nodiscard]] CellSet read_poly_cells(const std::filesystem::path& folder);

}  // namespace elrom::ingest
