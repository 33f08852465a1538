// Which way things go: gas rises and takes the solids along, pressure falls upward, solids lie low. Tells
// velocities whose sign was changed, and a case that stands on its head. That it must be so is known of a
// furnace that is described; elsewhere the other cases tell what is usual.

#include <cmath>

#include "correlation.hpp"
#include "physics_checks.hpp"

namespace elrom::ingest {
namespace {

class Directions {
 public:
  explicit Directions(const PhysicsView& view) : view_(view) {}

  void add(const std::string& quantity, const std::string& what, double value, double low, double high) {
    Reading reading{
        .check = "flow_direction", .quantity = quantity, .what = what, .value = value, .least_spread = 0.02};
    if (view_.is_described()) {
      reading.low = low;
      reading.high = high;
    }
    readings_.push_back(std::move(reading));
  }

  /// NaN where one of them is missing or constant. Weighted by volume.
  [[nodiscard]] double correlation(std::span<const float> a, std::span<const float> b) const {
    if (a.empty() || b.empty()) return std::nan("");
    return ingest::correlation(
        a.size(), view_.weight(), [&](std::size_t i) { return a[i]; }, [&](std::size_t i) { return b[i]; });
  }
  [[nodiscard]] double correlation_with_height(std::span<const float> a) const {
    return ingest::correlation(
        a.size(), view_.weight(), [&](std::size_t i) { return a[i]; },
        [&](std::size_t i) { return height(i); });
  }
  /// Mean over root mean square.
  [[nodiscard]] double one_way(std::span<const float> a) const {
    double sum = 0, square = 0, total = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const double w = view_.volume(i);
      sum += w * a[i];
      square += w * a[i] * a[i];
      total += w;
    }
    return sum / std::sqrt(total * square);
  }
  /// Height of the centre of mass of what `a` is the density of, over the furnace's.
  [[nodiscard]] double middle(std::span<const float> a) const {
    double sum = 0, total = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      sum += view_.volume(i) * a[i] * height(i);
      total += view_.volume(i) * a[i];
    }
    const auto z = view_.one.centre->col(2);
    return (sum / total - z.minCoeff()) / (z.maxCoeff() - z.minCoeff());
  }
  [[nodiscard]] std::vector<Reading> take() { return std::move(readings_); }

 private:
  [[nodiscard]] double height(std::size_t i) const {
    return (*view_.one.centre)(static_cast<Eigen::Index>(i), 2);
  }
  const PhysicsView& view_;
  std::vector<Reading> readings_;
};

}  // namespace

std::vector<Reading> read_flow_direction(const PhysicsView& view) {
  Directions directions(view);
  if (const auto gas = view.field("gas_velocity_z"); !gas.empty())
    directions.add("gas_velocity_z", "mean upward gas velocity over its root mean square",
                   directions.one_way(gas), 0, 1);
  for (const std::string axis : {"x", "y", "z"}) {
    const auto gas = "gas_velocity_" + axis, solid = "solid_velocity_" + axis;
    directions.add(solid, "correlation of " + solid + " and " + gas,
                   directions.correlation(view.field(solid), view.field(gas)), 0, 1);
  }
  if (const auto pressure = view.field("pressure"); !pressure.empty())
    directions.add("pressure", "correlation of pressure and height",
                   directions.correlation_with_height(pressure), -1, 0);
  if (const auto fraction = view.field("solid_volume_fraction"); !fraction.empty())
    directions.add("solid_volume_fraction", "height of the solids' centre of mass over the furnace's",
                   directions.middle(fraction), 0, 0.5);
  return directions.take();
}

}  // namespace elrom::ingest
