// Fields that say nothing of their own: one value in every cell, and a velocity that is a copy of another
// one, as it is or as a line of it (other unit, other frame). Phases may share a temperature, no velocity.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "correlation.hpp"
#include "physics_checks.hpp"

namespace elrom::ingest {
namespace {

// Rounding leaves 1e-7 of a constant, and 1e-14 of a copy.
constexpr double least_scatter = 1e-6;
// Of the 64 shipped training cases, the solids' velocities keep 1.6 % on a mesh of 300 cells, 8 % on 55,440.
constexpr double least_own = 1e-3;

/// Standard deviation over root mean square; 0 where all cells are equal.
double scatter(std::span<const float> cells) {
  if (std::ranges::all_of(cells, [&](float v) { return v == cells[0]; })) return 0;
  double sum = 0, square = 0;
  for (const double v : cells) {
    sum += v;
    square += v * v;
  }
  const auto n = static_cast<double>(cells.size());
  return std::sqrt(std::max(0.0, 1 - sum * sum / (n * square)));
}

Reading reading(const std::string& field, const std::string& what, double value, double low) {
  return {.check = "empty_field",
          .quantity = field,
          .what = what,
          .value = value,
          .low = low,
          .least_spread = physics_alone};
}

}  // namespace

std::vector<Reading> read_empty_fields(const PhysicsView& view) {
  std::vector<Reading> readings;
  std::vector<std::string> velocities;
  for (const auto& info : view.one.fields) {
    readings.push_back(reading(info.name, fmt::format("scatter of {} over its root mean square", info.name),
                               scatter(view.field(info.name)), least_scatter));
    if (info.unit == "m/s") velocities.push_back(info.name);
  }
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      const auto a = view.field(velocities[i]), b = view.field(velocities[k]);
      const double alike = correlation(
          a.size(), view.weight(), [&](std::size_t c) { return a[c]; }, [&](std::size_t c) { return b[c]; });
      readings.push_back(reading(
          velocities[i],
          fmt::format("share of the variance of {} that {} does not explain", velocities[i], velocities[k]),
          1 - alike * alike, least_own));
    }
  }
  return readings;
}

}  // namespace elrom::ingest
