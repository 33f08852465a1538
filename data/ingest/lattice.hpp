#pragma once
// Groups of nearly equal numbers, and cells that stand on a lattice.

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "elrom/ingest/own_mesh.hpp"

namespace elrom::ingest {

using Group = std::vector<std::size_t>;

/// The cells of `cells`, by a coordinate: groups ascend; a new one begins where the next number is more than
/// `tolerance` above the last.
[[nodiscard]] std::vector<Group> groups_of(const Group& cells, const MatrixD& centre, int axis,
                                           double tolerance);

/// Where every x, y and z of the centres has exactly one cell: the boxes that reach halfway to the neighbours
/// (an axis with one layer: as thick as the widest of the others, or 1 m), and their volumes where the cells
/// have none. @param tolerance [m], of each axis @return whether it was so
bool become_boxes(CellSet& cells, const std::array<double, 3>& tolerance);

}  // namespace elrom::ingest
