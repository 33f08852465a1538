#include "lattice.hpp"

#include <algorithm>
#include <numeric>

#include "cell_shapes.hpp"

namespace elrom::ingest {
namespace {

// Layers of one axis, and which of them each cell is in.
struct Layers {
  std::vector<double> place;  //!< mean coordinate [m]
  std::vector<std::size_t> of_cell;

  [[nodiscard]] std::size_t size() const { return place.size(); }
};

Layers layers_of(const MatrixD& centre, int axis, double tolerance) {
  Group all(static_cast<std::size_t>(centre.rows()));
  std::iota(all.begin(), all.end(), std::size_t{0});
  Layers layers{.of_cell = std::vector<std::size_t>(all.size())};
  for (const auto& group : groups_of(all, centre, axis, tolerance)) {
    double sum = 0;
    for (const auto cell : group) {
      sum += centre(static_cast<Eigen::Index>(cell), axis);
      layers.of_cell[cell] = layers.size();
    }
    layers.place.push_back(sum / static_cast<double>(group.size()));
  }
  return layers;
}

bool is_lattice(const std::array<Layers, 3>& layers, std::size_t n_cells) {
  const auto n_x = layers[0].size(), n_y = layers[1].size(), n_z = layers[2].size();
  if (n_cells < 2 || n_x > n_cells || n_y > n_cells || n_z > n_cells || n_cells / n_x / n_y != n_z ||
      n_x * n_y * n_z != n_cells)
    return false;
  std::vector<bool> taken(n_cells, false);
  for (std::size_t cell = 0; cell < n_cells; ++cell) {
    const auto place =
        layers[0].of_cell[cell] + n_x * (layers[1].of_cell[cell] + n_y * layers[2].of_cell[cell]);
    if (taken[place]) return false;
    taken[place] = true;
  }
  return true;
}

double widest_step(const Layers& layers) {
  double widest = 0;
  for (std::size_t i = 1; i < layers.size(); ++i)
    widest = std::max(widest, layers.place[i] - layers.place[i - 1]);
  return widest;
}

// Halfway between layers, and as far beyond the first and last.
std::vector<double> edges_of(const Layers& layers, double thickness) {
  const auto& x = layers.place;
  const auto n = x.size();
  if (n == 1) return {x[0] - thickness / 2, x[0] + thickness / 2};
  std::vector<double> edges{x[0] - (x[1] - x[0]) / 2};
  for (std::size_t i = 1; i < n; ++i) edges.push_back((x[i - 1] + x[i]) / 2);
  edges.push_back(x[n - 1] + (x[n - 1] - x[n - 2]) / 2);
  return edges;
}

}  // namespace

std::vector<Group> groups_of(const Group& cells, const MatrixD& centre, int axis, double tolerance) {
  const auto at = [&](std::size_t cell) { return centre(static_cast<Eigen::Index>(cell), axis); };
  auto sorted = cells;
  std::stable_sort(sorted.begin(), sorted.end(), [&](auto a, auto b) { return at(a) < at(b); });
  std::vector<Group> groups;
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || at(sorted[i]) - at(sorted[i - 1]) > tolerance) groups.emplace_back();
    groups.back().push_back(sorted[i]);
  }
  return groups;
}

bool become_boxes(CellSet& cells, const std::array<double, 3>& tolerance) {
  std::array<Layers, 3> layers;
  for (int axis = 0; axis < 3; ++axis)
    layers[static_cast<std::size_t>(axis)] =
        layers_of(cells.centre, axis, tolerance[static_cast<std::size_t>(axis)]);
  const auto n_cells = static_cast<std::size_t>(cells.centre.rows());
  if (!is_lattice(layers, n_cells)) return false;
  double thickness = 0;
  for (const auto& one : layers) thickness = std::max(thickness, widest_step(one));
  std::array<std::vector<double>, 3> edges;
  for (std::size_t d = 0; d < 3; ++d) edges[d] = edges_of(layers[d], thickness > 0 ? thickness : 1);
  const auto n_x = edges[0].size(), n_y = edges[1].size(), n_z = edges[2].size();
  cells.points.resize(static_cast<Eigen::Index>(n_x * n_y * n_z), 3);
  for (std::size_t i = 0; i < n_x * n_y * n_z; ++i)
    cells.points.row(static_cast<Eigen::Index>(i)) << edges[0][i % n_x], edges[1][i / n_x % n_y],
        edges[2][i / n_x / n_y];
  const bool measured = !cells.volume.empty();
  for (std::size_t cell = 0; cell < n_cells; ++cell) {
    const auto first =
        layers[0].of_cell[cell] + n_x * (layers[1].of_cell[cell] + n_y * layers[2].of_cell[cell]);
    Corners corners{};
    for (std::size_t i = 0; i < 4; ++i) {
      const std::size_t far_x = i == 1 || i == 2 ? 1 : 0, far_y = i >= 2 ? 1 : 0;
      corners[i] = static_cast<std::int32_t>(first + far_x + n_x * far_y);
      corners[i + 4] = corners[i] + static_cast<std::int32_t>(n_x * n_y);
    }
    cells.corners.insert(cells.corners.end(), corners.begin(), corners.end());
    if (!measured) cells.volume.push_back(volume_of(corners, cells.points));
  }
  return true;
}

}  // namespace elrom::ingest
