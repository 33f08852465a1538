#include "elrom/report/figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace elrom::report {
namespace {

// Columns of a plane as a grid: column = i_x + n_x * i_y.
struct Grid {
  std::size_t n_x = 1, n_y = 1;
};

Grid grid_of(const field::Mesh& mesh) {
  const double depth = mesh.centre.col(1).maxCoeff() - mesh.centre.col(1).minCoeff();
  const double same_row = 1e-6 * depth;
  std::size_t n_x = 1;
  while (n_x < mesh.n_columns &&
         std::abs(mesh.centre(static_cast<Eigen::Index>(n_x), 1) - mesh.centre(0, 1)) <= same_row)
    ++n_x;
  if (mesh.n_columns % n_x != 0) return {mesh.n_columns, 1};
  return {n_x, mesh.n_columns / n_x};
}

// Corners of hexahedron `cell` projected on (axis, z): the
// mean of the two corners that lie behind one another.
std::array<float, 8> quad_from_points(const field::Mesh& mesh, std::size_t cell, int axis) {
  // VTK order: 0 1 2 3 around the lower face, 4 5 6 7 above them; 0-1 runs along x, 0-3 along y.
  constexpr std::array<std::array<int, 2>, 4> along_x{{{0, 3}, {1, 2}, {5, 6}, {4, 7}}};
  constexpr std::array<std::array<int, 2>, 4> along_y{{{0, 1}, {3, 2}, {7, 6}, {4, 5}}};
  const auto& pairs = axis == 0 ? along_x : along_y;
  std::array<float, 8> quad{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto a = mesh.corners[cell * 8 + pairs[k][0]], b = mesh.corners[cell * 8 + pairs[k][1]];
    quad[2 * k] = static_cast<float>(0.5 * (mesh.points(a, axis) + mesh.points(b, axis)));
    quad[2 * k + 1] = static_cast<float>(0.5 * (mesh.points(a, 2) + mesh.points(b, 2)));
  }
  return quad;
}

// Without corner points: a rectangle that reaches halfway to the neighbours.
std::array<float, 8> quad_from_centre(const field::Mesh& mesh, std::size_t cell, int axis, double width,
                                      double height) {
  const auto u = static_cast<float>(mesh.centre(static_cast<Eigen::Index>(cell), axis));
  const auto v = static_cast<float>(mesh.centre(static_cast<Eigen::Index>(cell), 2));
  const auto du = static_cast<float>(width / 2), dv = static_cast<float>(height / 2);
  return {u - du, v - dv, u + du, v - dv, u + du, v + dv, u - du, v + dv};
}

// The one middle row of an odd number, or the two of an even one.
std::array<std::size_t, 2> middle(std::size_t n) { return {(n - 1) / 2, n / 2}; }

Cut middle_cut(const field::Mesh& mesh, const Grid& grid, int axis) {
  const std::size_t n_along = axis == 0 ? grid.n_x : grid.n_y;
  const auto across = middle(axis == 0 ? grid.n_y : grid.n_x);
  const auto column = [&](std::size_t along, std::size_t row) {
    return axis == 0 ? along + grid.n_x * row : row + grid.n_x * along;
  };
  const auto extent = [&](int k) { return mesh.centre.col(k).maxCoeff() - mesh.centre.col(k).minCoeff(); };
  const double width = n_along > 1 ? extent(axis) / static_cast<double>(n_along - 1) : 1;
  const double height = mesh.n_planes > 1 ? extent(2) / static_cast<double>(mesh.n_planes - 1) : 1;
  const bool has_points = mesh.corners.size() == mesh.n_cells() * 8;
  Cut cut{.horizontal = axis == 0 ? "x [m]" : "y [m]"};
  double place = 0;
  for (std::size_t i_plane = 0; i_plane < mesh.n_planes; ++i_plane)
    for (std::size_t along = 0; along < n_along; ++along) {
      const std::size_t first = i_plane * mesh.n_columns + column(along, across[0]);
      const std::size_t second = i_plane * mesh.n_columns + column(along, across[1]);
      cut.cells.push_back({first, second});
      place += 0.5 * (mesh.centre(static_cast<Eigen::Index>(first), 1 - axis) +
                      mesh.centre(static_cast<Eigen::Index>(second), 1 - axis));
      cut.corners.push_back(has_points ? quad_from_points(mesh, first, axis)
                                       : quad_from_centre(mesh, first, axis, width, height));
    }
  cut.title =
      fmt::format("{} = {:.2f} m", axis == 0 ? "y" : "x", place / static_cast<double>(cut.cells.size()));
  return cut;
}

// Whether columns come row by row; those of a mesh of somebody's own may not.
bool has_rows(const field::Mesh& mesh, const Grid& grid) {
  const double same_row = 1e-6 * (mesh.centre.col(1).maxCoeff() - mesh.centre.col(1).minCoeff());
  for (std::size_t column = 0; column < mesh.n_columns; ++column) {
    const auto first = column - column % grid.n_x;
    if (std::abs(mesh.centre(static_cast<Eigen::Index>(column), 1) -
                 mesh.centre(static_cast<Eigen::Index>(first), 1)) > same_row)
      return false;
  }
  return true;
}

// The box around each cell; a cell that is a point gets its share of the box around all.
class CellBoxes {
 public:
  explicit CellBoxes(const field::Mesh& mesh) : mesh_(mesh) {
    double size = 1;
    int n_axes = 0;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(extent(axis) > 0)) continue;
      size *= extent(axis);
      ++n_axes;
    }
    point_ = n_axes > 0 ? std::pow(size / static_cast<double>(mesh.n_cells()), 1.0 / n_axes) : 1;
  }

  /// Between the outermost centres [m]
  [[nodiscard]] double extent(int axis) const {
    return mesh_.centre.col(axis).maxCoeff() - mesh_.centre.col(axis).minCoeff();
  }
  [[nodiscard]] std::array<double, 2> range(std::size_t cell, int axis) const {
    const double centre = mesh_.centre(static_cast<Eigen::Index>(cell), axis);
    double low = centre, high = centre;
    for (std::size_t i = 8 * cell; i < std::min(8 * cell + 8, mesh_.corners.size()); ++i) {
      low = std::min(low, mesh_.points(mesh_.corners[i], axis));
      high = std::max(high, mesh_.points(mesh_.corners[i], axis));
    }
    if (low == high) return {centre - point_ / 2, centre + point_ / 2};
    return {low, high};
  }

 private:
  const field::Mesh& mesh_;
  double point_ = 1;  //!< side of a cell that is a point [m]
};

// The centre nearest to the middle of an axis, so that a cut there has a cell.
double middle_of(const field::Mesh& mesh, int axis) {
  const auto x = mesh.centre.col(axis);
  const double middle = 0.5 * (x.minCoeff() + x.maxCoeff());
  Eigen::Index nearest = 0;
  (x.array() - middle).abs().minCoeff(&nearest);
  return x(nearest);
}

// The cells that the middle plane across an axis goes through, as boxes.
Cut cut_through(const field::Mesh& mesh, const CellBoxes& boxes, int across) {
  static constexpr std::array<const char*, 3> labels{"x [m]", "y [m]", "z [m]"};
  const int u = across == 0 ? 1 : 0, v = across == 2 ? 1 : 2;
  const double middle = middle_of(mesh, across);
  Cut cut{.title = fmt::format("{} = {:.2f} m", labels[static_cast<std::size_t>(across)][0], middle),
          .horizontal = labels[static_cast<std::size_t>(u)],
          .vertical = labels[static_cast<std::size_t>(v)]};
  for (std::size_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto [low, high] = boxes.range(cell, across);
    if (middle < low || middle >= high) continue;
    const auto [left, right] = boxes.range(cell, u);
    const auto [bottom, top] = boxes.range(cell, v);
    const auto l = static_cast<float>(left), r = static_cast<float>(right), b = static_cast<float>(bottom),
               t = static_cast<float>(top);
    cut.cells.push_back({cell, cell});
    cut.corners.push_back({l, b, r, b, r, t, l, t});
  }
  return cut;
}

std::vector<Cut> cuts_through(const field::Mesh& mesh) {
  const CellBoxes boxes(mesh);
  for (const int axis : {2, 1, 0})
    if (!(boxes.extent(axis) > 0)) return {cut_through(mesh, boxes, axis)};
  return {cut_through(mesh, boxes, 1), cut_through(mesh, boxes, 0)};
}

std::size_t bin_of(double value, double low, double high, std::size_t n_bins) {
  const double position = (value - low) / (high - low) * static_cast<double>(n_bins);
  if (!(position > 0)) return 0;  // also where the value is not a number
  return std::min(n_bins - 1, static_cast<std::size_t>(std::min(position, 1e9)));
}

}  // namespace

std::vector<Cut> middle_cuts(const field::Mesh& mesh) {
  const auto grid = grid_of(mesh);
  if (mesh.n_planes == 1 || !has_rows(mesh, grid)) return cuts_through(mesh);
  std::vector<Cut> cuts;
  if (grid.n_x > 1 || grid.n_y == 1) cuts.push_back(middle_cut(mesh, grid, 0));
  if (grid.n_y > 1) cuts.push_back(middle_cut(mesh, grid, 1));
  return cuts;
}

std::vector<float> on_cuts(const std::vector<Cut>& cuts, std::span<const float> cells) {
  std::vector<float> values;
  for (const auto& cut : cuts)
    for (const auto& [first, second] : cut.cells) values.push_back(0.5F * (cells[first] + cells[second]));
  return values;
}

std::vector<double> plane_means(const field::Mesh& mesh, std::span<const float> cells) {
  std::vector<double> means(mesh.n_planes);
  for (std::size_t i_plane = 0; i_plane < mesh.n_planes; ++i_plane) {
    double sum = 0, volume = 0;
    for (std::size_t cell = i_plane * mesh.n_columns; cell < (i_plane + 1) * mesh.n_columns; ++cell) {
      sum += mesh.volume[cell] * cells[cell];
      volume += mesh.volume[cell];
    }
    means[i_plane] = sum / volume;
  }
  return means;
}

Histogram::Histogram(double low_edge, double high_edge, std::size_t n_bins)
    : low(low_edge), high(high_edge > low_edge ? high_edge : low_edge + 1), counts(n_bins, 0) {}
void Histogram::add(double value) { ++counts[bin_of(value, low, high, counts.size())]; }
std::uint64_t Histogram::total() const {
  return std::accumulate(counts.begin(), counts.end(), std::uint64_t{0});
}

ParityMap::ParityMap(double low_edge, double high_edge, std::size_t bins)
    : low(low_edge),
      high(high_edge > low_edge ? high_edge : low_edge + 1),
      n_bins(bins),
      counts(bins * bins, 0) {}
void ParityMap::add(double truth, double prediction) {
  ++counts[bin_of(truth, low, high, n_bins) * n_bins + bin_of(prediction, low, high, n_bins)];
}

}  // namespace elrom::report
