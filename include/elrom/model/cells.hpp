#pragma once
// Cells chosen by planes and box, their geometry in single
// precision, and averages over planes. Made once for a run.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "elrom/field/mesh.hpp"
#include "elrom/field/planes.hpp"
#include "elrom/io/vtkhdf.hpp"

namespace elrom::model {

/// A box in space [m]; sides that were left out are infinite.
struct Box {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  std::array<double, 3> low{-infinity, -infinity, -infinity};
  std::array<double, 3> high{infinity, infinity, infinity};
};

/// At least one cell, in the order of the mesh. Every function holds for every choice: whole planes only keep
/// no list of cells, and their numbers are computed.
class Cells {
 public:
  /// All cells of a mesh, which is not needed for that.
  Cells(std::size_t n_planes, std::size_t n_columns);
  /// Those of the planes, and with a box those whose centres lie in it.
  /// @param mesh of exactly `planes`, as BundleReader::mesh() gives it @param n_planes of the whole mesh
  /// @throws UsageError when no cell is left
  Cells(const field::Mesh& mesh, std::size_t n_planes, const field::Planes& planes = {},
        const std::optional<Box>& box = {});

  /// Planes with at least one chosen cell, ascending.
  [[nodiscard]] const std::vector<std::int32_t>& planes() const { return planes_; }
  [[nodiscard]] std::size_t n_columns() const { return n_columns_; }  ///< of the mesh
  /// Whether every column of every plane is chosen.
  [[nodiscard]] bool whole_planes() const { return !part_.has_value(); }
  [[nodiscard]] std::size_t size() const { return part_ ? part_->size() : planes_.size() * n_columns_; }

  // Of the i-th chosen cell, i < size():
  /// index of its plane in planes()
  [[nodiscard]] std::size_t plane_index(std::size_t i) const { return place(i) / n_columns_; }
  [[nodiscard]] std::int32_t plane(std::size_t i) const { return planes_[plane_index(i)]; }
  [[nodiscard]] std::int32_t column(std::size_t i) const {
    return static_cast<std::int32_t>(place(i) % n_columns_);
  }
  /// its number in the whole mesh: plane * n_columns + column
  [[nodiscard]] std::int32_t number(std::size_t i) const;
  /// its place in a prediction of planes()
  [[nodiscard]] std::size_t place(std::size_t i) const {
    return part_ ? static_cast<std::size_t>((*part_)[i]) : i;
  }
  /// its row in the mesh it was chosen from
  [[nodiscard]] std::size_t row(std::size_t i) const;

 private:
  std::vector<std::int32_t> planes_;
  std::vector<std::size_t> mesh_planes_;  //!< of each of planes_: its place in the mesh chosen from
  std::size_t n_columns_;
  std::optional<std::vector<std::int32_t>> part_;  //!< places, ascending; none: whole planes
};

/// Geometry of the chosen cells, points renumbered without gaps.
struct CellGeometry {
  std::vector<float> centre;  //!< [m], (cells.size(), 3)
  io::VtkHexahedra grid;
};
/// @param mesh which the cells were chosen from
[[nodiscard]] CellGeometry geometry_of(const field::Mesh& mesh, const Cells& cells);

/// Volume-weighted plane averages of the chosen cells.
class PlaneAverage {
 public:
  /// @param mesh which the cells were chosen from; its corners are not needed
  PlaneAverage(const field::Mesh& mesh, const Cells& cells);
  [[nodiscard]] const std::vector<float>& heights() const { return heights_; }  ///< mean z of each plane [m]
  /// @param values of the chosen cells, (cells.size()) @param averages (n_planes)
  void apply(std::span<const float> values, std::span<float> averages) const;

 private:
  std::vector<std::int32_t> plane_of_;  //!< index into the chosen planes, (cells.size())
  std::vector<double> weight_;          //!< share of its plane's volume, (cells.size())
  std::vector<float> heights_;
};

}  // namespace elrom::model
