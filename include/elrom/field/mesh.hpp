#pragma once
// The reduced mesh: n_planes horizontal planes of n_columns cells each (66 x 840
// for Lagisza); all sizes come from data. Order everywhere: plane-major, cell =
// i_plane * n_columns + i_column; points shared by hexahedra.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::io {
class Hdf5Group;
}

namespace elrom::field {

struct Mesh {
  std::size_t n_planes = 0, n_columns = 0;
  MatrixD centre;                     //!< cell centres: mean of the corners [m], (n_planes * n_columns, 3)
  std::vector<double> volume;         //!< [m3], (n_planes * n_columns)
  MatrixD points;                     //!< corner points [m], (n_points, 3)
  std::vector<std::int32_t> corners;  //!< points of each hexahedron in VTK order, (n_cells, 8)

  [[nodiscard]] std::size_t n_cells() const { return n_planes * n_columns; }
  /// SHA-256 over sizes and centres: the mesh's identity in stores, bundles and predictions.
  [[nodiscard]] std::string digest() const;
  /// Mean height of each plane [m], (n_planes).
  [[nodiscard]] std::vector<double> plane_heights() const;
};

/// A furnace of rectangular cross-sections, body-fitted: at height z the section spans [x_low(z), x_high(z)]
/// x [0, depth].
struct TaperedFurnace {
  double width_m = 10.6;        ///< full width in x
  double depth_m = 27.6;        ///< in y
  double height_m = 47.0;       ///< in z
  double bottom_width_m = 5.3;  ///< width in x at z = 0, centred; equal to width_m: no taper
  double taper_height_m = 47.0 * 6.0 / 33.0;
};

/// n_x * n_y columns (column = i_x + n_x * i_y) in n_planes planes of equal height. A mesh with twice the
/// cells in each direction is an exact refinement: the mean of eight children's centres is their parent's
/// centre. @throws UsageError for sizes < 1
[[nodiscard]] Mesh make_furnace_mesh(const TaperedFurnace& furnace, std::size_t n_x, std::size_t n_y,
                                     std::size_t n_planes);

/// Mesh file (data/FORMATS.md, kind "elrom-mesh"). @throws InputError
[[nodiscard]] Mesh read_mesh(const std::filesystem::path& path);
void write_mesh(const std::filesystem::path& path, const Mesh& mesh);

/// The same as a group of another file (store, prediction): attributes n_planes, n_columns; centre, volume,
/// points, corners.
[[nodiscard]] Mesh read_mesh(const io::Hdf5Group& group);
void write_mesh(const io::Hdf5Group& group, const Mesh& mesh);

}  // namespace elrom::field
