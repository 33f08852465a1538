#pragma once
// What of the furnace a prediction's result covers: all of it, some planes, a
// region; cells or plane averages. It says what to predict (planes), makes the
// result out of what was predicted, and says where the result's values lie.
//
// Thread rule: const use from any number of threads.

#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "elrom/model/bundle.hpp"
#include "elrom/model/cells.hpp"

namespace elrom::model {

/// The whole mesh as the bundle has it packed for prediction files.
struct PackedGeometry {
  io::Tensor centre, points, connectivity, offsets, types;
  std::size_t n_points = 0;
};

/// What a caller asks for.
struct Excerpt {
  field::Planes planes;
  std::optional<Box> box;  ///< of cells' centres
  bool profile = false;    ///< plane averages of those cells, weighted by volume, instead of the cells

  [[nodiscard]] bool everything() const { return planes.all() && !box && !profile; }
};

class Extent {
 public:
  /// Reads of the bundle what the excerpt needs: for all cells the packed mesh, where the bundle has it (from
  /// format 1.1 on), and else the mesh. @throws UsageError when it has no cell, InputError for a broken mesh
  explicit Extent(const BundleReader& bundle, const Excerpt& excerpt = {}, int n_threads = 1);
  /// Of a mesh at hand. @param mesh of exactly `excerpt.planes` @param n_planes of the whole mesh
  Extent(const field::Mesh& mesh, std::size_t n_planes, const Excerpt& excerpt = {});

  [[nodiscard]] const Cells& cells() const { return cells_; }
  /// Set: values are plane averages.
  [[nodiscard]] const PlaneAverage* average() const { return std::get_if<PlaneAverage>(&geometry_); }
  [[nodiscard]] const PackedGeometry* packed() const { return std::get_if<PackedGeometry>(&geometry_); }
  [[nodiscard]] const CellGeometry* geometry() const { return std::get_if<CellGeometry>(&geometry_); }
  /// Values of one field in one case: cells, or planes of a profile.
  [[nodiscard]] std::size_t n_values() const { return average() ? cells_.planes().size() : cells_.size(); }
  /// Whether a prediction of cells().planes() is the result as it is.
  [[nodiscard]] bool as_predicted() const { return cells_.whole_planes() && !average(); }

  /// @param predicted fields x cells().planes() x n_columns, or nothing
  /// @return fields x n_values(): `predicted` itself, or what was made of it in `buffer`
  [[nodiscard]] std::span<const float> choose(std::span<const float> predicted, std::size_t n_fields,
                                              std::vector<float>& buffer) const;

 private:
  using Geometry = std::variant<CellGeometry, PackedGeometry, PlaneAverage>;
  struct Parts {
    Cells cells;
    Geometry geometry;
  };
  explicit Extent(Parts parts) : cells_(std::move(parts.cells)), geometry_(std::move(parts.geometry)) {}
  static Parts read(const BundleReader& bundle, const Excerpt& excerpt, int n_threads);
  static Parts take(const field::Mesh& mesh, std::size_t n_planes, const Excerpt& excerpt);

  Cells cells_;
  Geometry geometry_;
};

}  // namespace elrom::model
