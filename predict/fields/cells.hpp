#pragma once
// Which cells are written, and their geometry as output files want it. Made once, used for every case.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "elrom/field/mesh.hpp"
#include "ranges.hpp"

namespace elrom::fields {

/// Cells chosen by planes and box, in the order of the mesh.
struct Cells {
  std::vector<std::int32_t> planes;  //!< planes with at least one chosen cell, ascending
  std::size_t n_columns = 0;         //!< of the mesh
  bool whole_planes = true;          //!< every column of every plane
  std::vector<std::int32_t>
      cells;  //!< chosen cells (plane * n_columns + column), (size()); empty: all_cells()
  std::vector<std::int32_t> sources;  //!< place of each in a prediction of `planes`; empty with whole planes
  std::vector<std::int32_t> rows;     //!< place of each in the mesh they were chosen from

  [[nodiscard]] std::size_t size() const { return cells.empty() ? planes.size() * n_columns : cells.size(); }
};

/// Every cell, for which neither the mesh nor a list is needed.
[[nodiscard]] Cells all_cells(std::size_t n_planes, std::size_t n_columns);
/// @param mesh of `planes` only @param planes their numbers in the whole mesh; empty: all. @throws UsageError when no cell is left
[[nodiscard]] Cells choose_cells(const field::Mesh& mesh, std::vector<std::int32_t> planes,
                                 const std::optional<Box>& box);

/// Geometry of the chosen cells, from the mesh they were chosen from, in single precision, points renumbered without gaps.
struct CellGeometry {
  std::vector<float> centre;               //!< [m], (size(), 3)
  std::vector<float> points;               //!< [m], (n_points, 3)
  std::vector<std::int32_t> connectivity;  //!< (size(), 8), VTK hexahedron order
  std::vector<std::int32_t> offsets;       //!< (size() + 1)
  std::vector<std::uint8_t> types;         //!< VTK cell type of each, (size())
};
[[nodiscard]] CellGeometry geometry_of(const field::Mesh& mesh, const Cells& cells);

/// Volume-weighted plane averages of the chosen cells.
class PlaneAverage {
 public:
  PlaneAverage(const field::Mesh& mesh, const Cells& cells);
  [[nodiscard]] const std::vector<float>& heights() const { return heights_; }  ///< mean z of each plane [m]
  /// @param values of the chosen cells, (cells.size()) @param averages (n_planes)
  void apply(std::span<const float> values, std::span<float> averages) const;

 private:
  std::vector<std::int32_t> plane_of_;  //!< index into the chosen planes, (cells.size())
  std::vector<double> weight_;          //!< share of its plane's volume, (cells.size())
  std::vector<float> heights_;
};

}  // namespace elrom::fields
