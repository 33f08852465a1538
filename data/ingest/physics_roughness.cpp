// How much a field changes from cell to cell, beside how much it changes at all: the mean squared difference
// of neighbours over twice the variance (von Neumann 1941). Near 1 where cells know nothing of their
// neighbours: a field whose cells lost their places. Resampling to a finer mesh smooths; so the share of the
// variance that lies within coarse boxes is read too: of such a field nearly all, on any mesh. An instant in
// the place of an average is rougher in all velocities at once.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "boxes.hpp"
#include "physics_checks.hpp"

namespace elrom::ingest {
namespace {

/// For every column the nearest other one, by the centres of a plane in the middle.
std::vector<std::size_t> nearest_columns(const field::Mesh& mesh) {
  const auto first = static_cast<Eigen::Index>(mesh.n_planes / 2 * mesh.n_columns);
  const auto n = static_cast<Eigen::Index>(mesh.n_columns);
  std::vector<std::size_t> nearest(mesh.n_columns);
  for (Eigen::Index a = 0; a < n; ++a) {
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index b = 0; b < n; ++b) {
      const double square = (mesh.centre.row(first + a) - mesh.centre.row(first + b)).squaredNorm();
      if (a == b || square >= least) continue;
      least = square;
      nearest[static_cast<std::size_t>(a)] = static_cast<std::size_t>(b);
    }
  }
  return nearest;
}

double variance(std::span<const float> cells) {
  double mean = 0, sum = 0;
  for (const double v : cells) mean += v;
  mean /= static_cast<double>(cells.size());
  for (const double v : cells) sum += (v - mean) * (v - mean);
  return sum / static_cast<double>(cells.size());
}

/// Mean over neighbours above each other and neighbours beside each other.
double roughness(std::span<const float> cells, const field::Mesh& mesh,
                 const std::vector<std::size_t>& beside) {
  const auto square = [&](std::size_t a, std::size_t b) {
    const double d = double{cells[a]} - cells[b];
    return d * d;
  };
  double above = 0, aside = 0;
  for (std::size_t plane = 0; plane < mesh.n_planes; ++plane) {
    const auto first = plane * mesh.n_columns;
    for (std::size_t c = 0; c < mesh.n_columns; ++c) {
      aside += square(first + c, first + beside[c]);
      if (plane > 0) above += square(first + c, first + c - mesh.n_columns);
    }
  }
  const auto n = static_cast<double>(mesh.n_cells());
  const double mean = 0.5 * (above / (n - static_cast<double>(mesh.n_columns)) + aside / n);
  return mean / (2 * variance(cells));
}

std::vector<int> box_of_cells(const CheckedCase& one) {
  const Boxes boxes(one);
  std::vector<int> box(static_cast<std::size_t>(one.values.cols()));
  for (std::size_t i = 0; i < box.size(); ++i) box[i] = boxes.box(static_cast<Eigen::Index>(i));
  return box;
}

/// Share of the variance that lies within boxes.
double share_within(std::span<const float> cells, const std::vector<int>& box) {
  std::array<double, Boxes::n_boxes> sum{}, count{};
  double mean = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    sum[static_cast<std::size_t>(box[i])] += cells[i];
    count[static_cast<std::size_t>(box[i])] += 1;
    mean += cells[i];
  }
  const auto n = static_cast<double>(cells.size());
  mean /= n;
  double between = 0;
  for (std::size_t b = 0; b < sum.size(); ++b) {
    if (count[b] > 0) between += (sum[b] / count[b] - mean) * (sum[b] - count[b] * mean);
  }
  return 1 - between / (n * variance(cells));
}

std::vector<Reading> read_neighbours(const PhysicsView& view) {
  std::vector<Reading> readings;
  const auto* mesh = view.one.mesh;
  if (!mesh || mesh->n_planes < 4 || mesh->n_columns < 4) return readings;
  const auto beside = nearest_columns(*mesh);
  for (const auto& info : view.one.fields) {
    readings.push_back({.check = "roughness",
                        .quantity = info.name,
                        .what = "roughness of " + info.name + " from cell to cell",
                        .value = roughness(view.field(info.name), *mesh, beside),
                        .least_spread = 0.05,
                        .logarithmic = true});
  }
  return readings;
}

/// Geometric mean over the velocities.
template <class Value>
double mean_of_velocities(const PhysicsView& view, Value value) {
  double sum = 0, n = 0;
  for (std::size_t f = 0; f < view.one.fields.size(); ++f) {
    if (view.one.fields[f].unit != "m/s") continue;
    sum += std::log(value(f));
    n += 1;
  }
  return std::exp(sum / n);
}

// Sound cases lie up to 3.6 spreads out in stores of eight of the 64 shipped training cases, drawn at random,
// 3.0 in stores of 12, 2.5 of 20, 2.1 of 40 (400 draws of each, on 300 cells and on 55,440).
Reading unlike_averages(const std::string& what, double value) {
  return {.check = "roughness",
          .what = what,
          .value = value,
          .least_spread = 0.05,
          .logarithmic = true,
          .reach = 3.5,
          .few_cases = 6,
          .only_above = true};
}

/// What an instant in the place of an average shows: all velocities are rough at once, from cell to cell and
/// within the reduced mesh's cells.
void add_instant(const PhysicsView& view, std::vector<Reading>& readings) {
  if (!readings.empty())
    readings.push_back(
        unlike_averages("roughness of the velocities from cell to cell, in the mean,",
                        mean_of_velocities(view, [&](std::size_t f) { return readings[f].value; })));
  const auto& errors = view.one.resampling_error;
  if (errors.empty()) return;
  // Mean squares of what the mesh keeps and of what it loses sum up to the field's own.
  const auto kept = [&](std::size_t f) { return std::sqrt(std::max(1e-6, 1 - errors[f] * errors[f])); };
  readings.push_back(
      unlike_averages("scatter of the velocities over what the reduced mesh keeps of it, in the mean,",
                      mean_of_velocities(view, [&](std::size_t f) { return 1 / kept(f); })));
}

}  // namespace

std::vector<Reading> read_roughness(const PhysicsView& view) {
  auto readings = read_neighbours(view);
  add_instant(view, readings);
  // EL3D's fields reach 0.88; cells without a place 1 - 1 / (cells in a box).
  constexpr double most_within = 0.92;
  constexpr Eigen::Index fewest_in_a_box = 20;
  if (view.one.values.cols() < fewest_in_a_box * Boxes::n_boxes) return readings;
  const auto box = box_of_cells(view.one);
  for (const auto& info : view.one.fields) {
    readings.push_back({.check = "roughness",
                        .quantity = info.name,
                        .what = fmt::format("share of the variance of {} within {} boxes of cells", info.name,
                                            Boxes::n_boxes),
                        .value = share_within(view.field(info.name), box),
                        .high = most_within,
                        .least_spread = std::numeric_limits<double>::infinity()});
  }
  return readings;
}

}  // namespace elrom::ingest
