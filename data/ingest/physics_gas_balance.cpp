// Gas flow through planes, over what enters below: tells reversed, scaled and exchanged gas velocities, and
// inlets whose values changed places with one that enters at another height.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/text.hpp"
#include "physics_checks.hpp"

namespace elrom::ingest {
namespace {

// What enters must pass. Clear of openings, the averages of the 64 shipped training cases carry 91 to 101 %
// of it, as the product of averages stands for the average of the product. Three times as far off is wrong.
constexpr double least_clear = 0.7, most_clear = 1.4;
// Beside openings, cells see parts of jets.
constexpr double least_beside = 0.25, most_beside = 3;
constexpr double least_spread = 0.01;

class GasBalance {
 public:
  explicit GasBalance(const PhysicsView& view)
      : one_(view.one), planes_(view.audit->planes), openings_(view.one.furnace->openings) {}

  std::vector<Reading> read() {
    clear_planes();
    between_openings();
    return std::move(readings_);
  }

 private:
  void add(std::string where, double value, double low, double high) {
    readings_.push_back({.check = "gas_balance",
                         .quantity = "gas_velocity_z",
                         .what = "gas flow at " + std::move(where) + " over that of the inlets below",
                         .value = value,
                         .low = low,
                         .high = high,
                         .least_spread = least_spread});
  }

  /// Planes beside an opening have no balance in the audit, so those between two of them have one inflow.
  void clear_planes() {
    const auto has_balance = [&](std::size_t i) {
      return std::isfinite(planes_[i].gas_inflow) && std::isfinite(planes_[i].gas_flow);
    };
    for (std::size_t begin = 0; begin < planes_.size(); ++begin) {
      std::size_t end = begin;
      double sum = 0;
      for (; end < planes_.size() && has_balance(end); ++end)
        sum += planes_[end].gas_flow / planes_[end].gas_inflow;
      if (end == begin) continue;
      add(fmt::format("{:.1f} to {:.1f} m", planes_[begin].height, planes_[end - 1].height),
          sum / static_cast<double>(end - begin), least_clear, most_clear);
      begin = end;
    }
  }

  /// At the edges of openings that the planes resolve: what entered below is known there too.
  void between_openings() {
    std::vector<double> edges;
    for (const auto& opening : openings_) edges.insert(edges.end(), {opening.low_m, opening.high_m});
    std::sort(edges.begin(), edges.end());
    const auto is_near = [](double a, double b) { return std::abs(a - b) < 1e-6; };
    edges.erase(std::unique(edges.begin(), edges.end(), is_near), edges.end());
    for (std::size_t i = 1; i < edges.size(); ++i) {
      const double gap = edges[i] - edges[i - 1];
      for (std::size_t p = 0; p + 1 < planes_.size(); ++p) {
        const auto &below = planes_[p], &above = planes_[p + 1];
        const double step = above.height - below.height;
        if (below.height > edges[i] || above.height <= edges[i] || step > 1.1 * gap) continue;
        const double share = (edges[i] - below.height) / step;
        add(fmt::format("{:.1f} m", edges[i]),
            ((1 - share) * below.gas_flow + share * above.gas_flow) / entered_below(edges[i]), least_beside,
            most_beside);
      }
    }
  }

  /// Gas enters evenly over the height of its opening [kg/s].
  [[nodiscard]] double entered_below(double height) const {
    double flow = 0;
    for (const auto& opening : openings_) {
      const double size = opening.high_m - opening.low_m;
      const double share = size > 0 ? std::clamp((height - opening.low_m) / size, 0.0, 1.0)
                                    : (height >= opening.low_m ? 1.0 : 0.0);
      for (std::size_t i = 0; i < one_.schema->size(); ++i) {
        const auto& input = (*one_.schema)[i];
        if (input.unit == "kg/s" && base::matches(input.name, opening.inputs)) flow += share * one_.inputs[i];
      }
    }
    return flow;
  }

  const CheckedCase& one_;
  const std::vector<model::PlaneAudit>& planes_;
  const std::vector<field::Opening>& openings_;
  std::vector<Reading> readings_;
};

}  // namespace

std::vector<Reading> read_gas_balance(const PhysicsView& view) {
  if (!view.audit || !view.one.furnace) return {};
  return GasBalance(view).read();
}

}  // namespace elrom::ingest
