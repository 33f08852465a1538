#pragma once
// Cells of a VTK XML unstructured grid (.vtu), as ParaView, meshio and most CFD codes write it.
//
// Read: one piece; arrays in ascii, base64 (inline or appended) or raw (appended); without compression or
// with zlib's; 32- and 64-bit headers; cells of types tetrahedron, voxel, hexahedron, wedge, pyramid, and
// triangle, pixel, quad, which count as 1 m deep.
// Non-goals: several pieces, polyhedra, curved cells, big-endian files, other compressors, data on cells.

#include <filesystem>

#include "elrom/ingest/own_mesh.hpp"

namespace elrom::ingest {

/// Centres are the means of cells' points. @throws InputError for a damaged file, or what is not read
[[nodiscard]] CellSet read_vtu(const std::filesystem::path& path);

}  // namespace elrom::ingest
