#pragma once
// What of a prediction a page shows: plane cuts through the furnace and averages over its planes, instead of
// all cells. A cut is made of the cells themselves, so that no value is interpolated.
//
// Thread rule: const use from any thread.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "elrom/base/large_array.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/model/cells.hpp"

namespace elrom::serve {

/// The plane where one coordinate has a value.
struct Cut {
  std::size_t axis = 0;  ///< 0 x, 1 y, 2 z
  double at = 0;         ///< [m]
};

/// Where a cut meets the cells: a convex polygon for each.
struct CutPolygons {
  std::vector<std::int32_t> cells;    ///< number in the mesh, ascending, (n)
  std::vector<std::int32_t> offsets;  ///< of each cell's points, (n + 1)
  std::vector<float> points;          ///< [m], around each polygon, (n_points, 3)
};

class Cuts {
 public:
  /// @param mesh with corners
  explicit Cuts(field::Mesh mesh);

  [[nodiscard]] const std::array<double, 3>& low() const { return low_; }  ///< of the mesh's points [m]
  [[nodiscard]] const std::array<double, 3>& high() const { return high_; }
  [[nodiscard]] const std::vector<float>& heights() const { return average_.heights(); }
  [[nodiscard]] bool meets(const Cut& cut) const {
    return cut.at >= low_[cut.axis] && cut.at <= high_[cut.axis];
  }

  /// Cells that the cut goes through, ascending; of a cut between two layers those above it.
  [[nodiscard]] std::vector<std::int32_t> cells(const Cut& cut) const;
  [[nodiscard]] CutPolygons polygons(const Cut& cut) const;
  /// @param field (n_cells) @param averages (heights())
  void profile(std::span<const float> field, std::span<float> averages) const {
    average_.apply(field, averages);
  }

 private:
  [[nodiscard]] double coordinate(std::int32_t cell, std::size_t corner, std::size_t axis) const;
  [[nodiscard]] double within(const Cut& cut) const;
  void add_polygon(std::int32_t cell, std::size_t axis, double at, CutPolygons& polygons) const;

  field::Mesh mesh_;
  model::PlaneAverage average_;
  std::array<double, 3> low_, high_;
  std::array<std::vector<double>, 3> cell_low_, cell_high_;  //!< (n_cells) for each axis [m]
};

/// What a caller asks for.
struct Excerpt {
  std::vector<Cut> cuts;
  bool profile = false;  ///< volume-weighted averages of the planes
  [[nodiscard]] bool everything() const { return cuts.empty() && !profile; }
};

/// The parts of an excerpt, one behind another for each field.
class ExcerptParts {
 public:
  ExcerptParts(const Cuts& cuts, const Excerpt& excerpt);

  [[nodiscard]] const std::vector<std::size_t>& begins() const { return begins_; }  ///< of parts, and the end
  [[nodiscard]] std::size_t n_values() const { return begins_.back(); }             ///< of one field
  /// @param all (n_fields, n_cells) @return (n_fields, n_values()): cuts as asked for, then the profile
  [[nodiscard]] base::LargeArray<float> of(const base::LargeArray<float>& all, std::size_t n_cells) const;

 private:
  const Cuts& cuts_;
  std::vector<std::vector<std::int32_t>> cells_;  //!< of each cut
  bool profile_;
  std::vector<std::size_t> begins_{0};
};

}  // namespace elrom::serve
