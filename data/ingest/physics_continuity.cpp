// Gas is neither made nor lost: where it spreads sideways, it thins upward. Tells horizontal velocities that
// changed places or sign, whatever the furnace's shape, and fields whose cells lost their places.

#include <array>
#include <cmath>
#include <limits>

#include "correlation.hpp"
#include "physics_checks.hpp"

namespace elrom::ingest {
namespace {

// The 64 shipped training cases have 0.40 to 0.49 on 55,440 cells, more on the CFD's mesh and on a coarse
// one: differences over cells see less than all. Half of the least is wrong; without continuity it is 0.
constexpr double least_correlation = 0.2;

/// Of every column the nearest ones towards either side along an axis; itself at a wall.
struct Sides {
  std::vector<std::size_t> low, high;

  Sides(const field::Mesh& mesh, Eigen::Index axis) : low(mesh.n_columns), high(mesh.n_columns) {
    const auto first = static_cast<Eigen::Index>(mesh.n_planes / 2 * mesh.n_columns);
    const auto plane = mesh.centre.block(first, 0, static_cast<Eigen::Index>(mesh.n_columns), 2);
    for (Eigen::Index a = 0; a < plane.rows(); ++a) {
      double nearest_low = std::numeric_limits<double>::infinity(), nearest_high = nearest_low;
      low[static_cast<std::size_t>(a)] = high[static_cast<std::size_t>(a)] = static_cast<std::size_t>(a);
      for (Eigen::Index b = 0; b < plane.rows(); ++b) {
        const Eigen::RowVector2d way = plane.row(b) - plane.row(a);
        if (std::abs(way[axis]) <= std::abs(way[1 - axis])) continue;
        auto& nearest = way[axis] > 0 ? nearest_high : nearest_low;
        if (way.squaredNorm() >= nearest) continue;
        nearest = way.squaredNorm();
        (way[axis] > 0 ? high : low)[static_cast<std::size_t>(a)] = static_cast<std::size_t>(b);
      }
    }
  }
};

/// Differences over neighbours, two apart, or one at a wall. 0 where there is no neighbour.
class Slopes {
 public:
  explicit Slopes(const field::Mesh& mesh) : mesh_(mesh), sides_{Sides(mesh, 0), Sides(mesh, 1)} {}

  [[nodiscard]] double beside(const std::vector<double>& f, std::size_t cell, std::size_t axis) const {
    const auto column = cell % mesh_.n_columns, first = cell - column;
    return over(f, first + sides_[axis].low[column], first + sides_[axis].high[column], axis);
  }
  /// Columns may lean: the change on the way sideways is taken off.
  [[nodiscard]] double upward(const std::vector<double>& f, std::size_t cell) const {
    const auto n = mesh_.n_columns;
    const auto below = cell >= n ? cell - n : cell, above = cell + n < mesh_.n_cells() ? cell + n : cell;
    double slope = over(f, below, above, 2);
    for (std::size_t axis = 0; axis < 2; ++axis)
      slope -= beside(f, cell, axis) * way(below, above, axis) / way(below, above, 2);
    return slope;
  }

 private:
  [[nodiscard]] double way(std::size_t from, std::size_t to, std::size_t axis) const {
    const auto at = [&](std::size_t cell) {
      return mesh_.centre(static_cast<Eigen::Index>(cell), static_cast<Eigen::Index>(axis));
    };
    return at(to) - at(from);
  }
  [[nodiscard]] double over(const std::vector<double>& f, std::size_t from, std::size_t to,
                            std::size_t axis) const {
    return from == to ? 0 : (f[to] - f[from]) / way(from, to, axis);
  }

  const field::Mesh& mesh_;
  std::array<Sides, 2> sides_;
};

/// Gas volume that passes, by area: velocity times the share of the volume that is gas.
std::vector<double> flux(std::span<const float> velocity, std::span<const float> solids) {
  std::vector<double> result(velocity.begin(), velocity.end());
  for (std::size_t i = 0; i < solids.size(); ++i) result[i] *= 1 - double{solids[i]};
  return result;
}

}  // namespace

std::vector<Reading> read_continuity(const PhysicsView& view) {
  const auto* mesh = view.one.mesh;
  const auto x = view.field("gas_velocity_x"), y = view.field("gas_velocity_y"),
             z = view.field("gas_velocity_z");
  if (!mesh || mesh->n_planes < 4 || mesh->n_columns < 4 || x.empty() || y.empty() || z.empty()) return {};
  const auto solids = view.field("solid_volume_fraction");
  const auto flux_x = flux(x, solids), flux_y = flux(y, solids), flux_z = flux(z, solids);
  const Slopes slopes(*mesh);
  const auto n = mesh->n_cells();
  std::vector<double> spreading(n), thinning(n);
  for (std::size_t i = 0; i < n; ++i) {
    spreading[i] = slopes.beside(flux_x, i, 0) + slopes.beside(flux_y, i, 1);
    thinning[i] = -slopes.upward(flux_z, i);
  }
  const double value = correlation(
      n, view.weight(), [&](std::size_t i) { return spreading[i]; },
      [&](std::size_t i) { return thinning[i]; });
  Reading reading{.check = "continuity",
                  .what = "correlation of the gas's spreading sideways and its thinning upward",
                  .value = value,
                  .least_spread = 0.02};
  if (view.is_described()) reading.low = least_correlation;
  return {reading};
}

}  // namespace elrom::ingest
