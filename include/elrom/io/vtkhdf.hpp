#pragma once
// Group /VTKHDF of an HDF5 file: an unstructured grid of hexahedra with one
// value or vector a cell, as ParaView 5.11 and later open it (VTKHDF 1.0).
//
// Non-goals: other cells, points' values, time steps, reading. Thread rule: one thread at a time per file.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "elrom/io/hdf5.hpp"

namespace elrom::io {

/// Points and cells the way VTK wants them.
struct VtkHexahedra {
  std::vector<float> points;               //!< [m], (n_points, 3)
  std::vector<std::int32_t> connectivity;  //!< points of each cell in VTK order, (n_cells, 8)
  std::vector<std::int32_t> offsets;       //!< (n_cells + 1)
  std::vector<std::uint8_t> types;         //!< (n_cells)

  VtkHexahedra() = default;
  VtkHexahedra(std::vector<float> points_of_cells, std::vector<std::int32_t> corners);
  [[nodiscard]] std::size_t n_points() const { return points.size() / 3; }
  [[nodiscard]] std::size_t n_cells() const { return types.size(); }
};

/// The same, each array a chunk of pack_chunk(): nothing is left to do but to copy the bytes.
struct PackedVtkHexahedra {
  std::span<const std::uint8_t> points, connectivity, offsets, types;
  std::size_t n_points = 0, n_cells = 0;
};

/// Creates the group. @return its CellData, for show_cell_data(). @throws SystemError
[[nodiscard]] Hdf5Group write_vtkhdf(const Hdf5Group& file, const VtkHexahedra& grid);
[[nodiscard]] Hdf5Group write_vtkhdf(const Hdf5Group& file, const PackedVtkHexahedra& grid);

/// One value a cell in one row, without a second copy: a link to the dataset at the absolute path `target`
/// where it has one dimension, a view of it where it has several.
void show_cell_data(const Hdf5Group& cell_data, const Hdf5Dataset& values, const std::string& target,
                    const std::string& name);
/// One vector a cell, as streamlines want it: a view of its components, so that no value is there twice.
void show_cell_vectors(const Hdf5Group& cell_data, std::span<const Hdf5Dataset> components,
                       const std::string& name);

}  // namespace elrom::io
