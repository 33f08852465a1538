#pragma once
// A reduced mesh of one's own: the cells of any mesh, brought into planes of equally many columns.
//
// Cells whose coordinates along the axis differ by no more than a tolerance are a plane. Where all planes
// have equally many cells, and more than one, the mesh is layered: planes ascend, and a column is the same
// place in every plane, or, where planes differ in shape (a taper), the same place in the order by rows.
// What is not layered is one plane, in the order of the source. What predicts knows the planes' numbers and
// nothing else of where a cell lies, so any mesh can be one plane.
//
// Where only centres are known, and they stand on a lattice (every x with every y and z), cells are the boxes
// that reach halfway to the neighbours; else they are drawn as points.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "elrom/field/mesh.hpp"

namespace elrom::ingest {

/// Cells in the order of their source.
struct CellSet {
  MatrixD centre;                     //!< [m], (n_cells, 3)
  std::vector<double> volume;         //!< [m3], (n_cells); empty: not known
  MatrixD points;                     //!< corner points [m], (n_points, 3)
  std::vector<std::int32_t> corners;  //!< as in field::Mesh, (n_cells, 8); empty: only centres are known
};

/// By what is there: an OpenFOAM case or its polyMesh, a .vtu file, HDF5 with /mesh/centre, a table of
/// centres (data/FORMATS.md, "Sources of a mesh"). @throws InputError
[[nodiscard]] CellSet read_cells(const std::filesystem::path& path);

struct Grouping {
  int axis = 2;                         ///< planes lie across it: 0, 1, 2 for x, y, z
  std::optional<std::size_t> n_planes;  ///< 1: one plane, layered or not; others must be what is found
  std::optional<double> tolerance_m;    ///< without: 1e-5 of the mesh's extent along each axis
};

struct OwnMesh {
  field::Mesh mesh;
  bool layered = true;      ///< false: one plane because there are no planes of equally many cells
  bool has_volumes = true;  ///< false: every cell counts alike, as 1 m3
  bool has_corners = true;  ///< false: cells are drawn as points
};

/// @param where the cells are from, for messages @throws InputError for planes that are not there, no cells
[[nodiscard]] OwnMesh group_into_planes(CellSet cells, const Grouping& grouping, const std::string& where);

}  // namespace elrom::ingest
