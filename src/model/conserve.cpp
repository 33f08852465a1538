// Smallest-change repair: a weighted least-squares projection onto the conservation constraints.
// Minimise sum V (d / s)^2 subject to sum a d = r: stationarity gives d = m s^2 a / V with one multiplier m.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "audit_planes.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/model/audit.hpp"

namespace elrom::model {
namespace {

using namespace audit_detail;

struct Change {
  double squared = 0, squared_field = 0, volume = 0;
  void add(double before, double after, double cell_volume) {
    squared += cell_volume * (after - before) * (after - before);
    squared_field += cell_volume * before * before;
    volume += cell_volume;
  }
  [[nodiscard]] double rms() const { return volume > 0 ? std::sqrt(squared / volume) : 0; }
  [[nodiscard]] double relative() const { return squared_field > 0 ? std::sqrt(squared / squared_field) : 0; }
};

// The volume fraction of solids, with what its change is measured by.
struct Fraction {
  const field::Mesh& mesh;
  std::span<const float> values;
  std::vector<double> scale;
  double density, most;

  /// Moved by multiplier m, inside the bounds.
  [[nodiscard]] double moved(std::size_t c, double m) const {
    return std::clamp(values[c] + m * scale[c] * scale[c], 0.0, most);
  }
  [[nodiscard]] double mass_at(double m) const {
    double mass = 0;
    for (std::size_t c = 0; c < values.size(); ++c) mass += density * mesh.volume[c] * moved(c, m);
    return mass;
  }
};

// The mass grows with m, so a bracket and bisection find it whatever bounds become active.
double multiplier_for(const Fraction& fraction, double target) {
  const auto mass = [&](double m) { return fraction.mass_at(m); };
  double low = -1, high = 1;
  for (int i = 0; i < 200 && mass(low) > target; ++i) low *= 2;
  for (int i = 0; i < 200 && mass(high) < target; ++i) high *= 2;
  if (mass(low) > target || mass(high) < target)
    throw NumericalError({.what = "no solid volume fraction inside its bounds holds the inventory",
                          .found = base::rounded(target) + " kg",
                          .expected = "between 0 and " + base::rounded(mass(high)) + " kg"});
  for (int i = 0; i < 100 && high - low > 1e-15 * (std::abs(low) + std::abs(high)); ++i) {
    const double middle = 0.5 * (low + high);
    (mass(middle) < target ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

void conserve_solids(const CaseView& view, std::span<float> values, std::span<const float> scale_of_values,
                     const AuditSettings& settings, ConservationChange& result) {
  const auto i_fraction = find_field(view, "solid_volume_fraction");
  const auto inventory = input_value(view, "solids_inventory");
  if (!i_fraction || !inventory) return;
  const std::size_t n_cells = view.mesh.n_cells();
  const auto values_of_fraction = values.subspan(*i_fraction * n_cells, n_cells);
  Fraction fraction{.mesh = view.mesh,
                    .values = values_of_fraction,
                    .scale = std::vector<double>(n_cells),
                    .density = settings.solid_density,
                    .most = view.fields[*i_fraction].upper.value_or(1)};
  for (std::size_t c = 0; c < n_cells; ++c)
    fraction.scale[c] = scale_of_values.empty() ? std::max(double{fraction.values[c]}, 1e-6)
                                                : scale_of_values[*i_fraction * n_cells + c];

  const double before = fraction.mass_at(0);
  const double m = multiplier_for(fraction, *inventory);
  Change change;
  for (std::size_t c = 0; c < n_cells; ++c) {
    const double after = fraction.moved(c, m);
    change.add(fraction.values[c], after, view.mesh.volume[c]);
    values_of_fraction[c] = static_cast<float>(after);
  }
  result.solids_kg = *inventory - before;
  result.volume_fraction_rms = change.rms();
  result.volume_fraction_relative = change.relative();
}

void conserve_gas(const CaseView& view, std::span<float> values, std::span<const float> scale,
                  const AuditSettings& settings, ConservationChange& result) {
  const auto i_gas = find_field(view, "gas_velocity_z");
  const auto i_fraction = find_field(view, "solid_volume_fraction");
  const auto density = gas_density(view, settings);
  if (!i_gas || !i_fraction || !density) return;
  const std::size_t n_cells = view.mesh.n_cells(), n_columns = view.mesh.n_columns;
  const auto gas = values.subspan(*i_gas * n_cells, n_cells),
             fraction = values.subspan(*i_fraction * n_cells, n_cells);
  const auto edges = plane_edges(view.mesh);
  Change change;
  for (std::size_t i_plane = 0; i_plane < view.mesh.n_planes; ++i_plane) {
    const double target = inflow_below(view, settings, edges[i_plane]);
    if (!std::isfinite(target)) continue;
    const auto variance = [&](std::size_t c) {
      return scale.empty() ? 1.0 : double{scale[*i_gas * n_cells + c]} * scale[*i_gas * n_cells + c];
    };
    double flow = 0, response = 0;
    for (std::size_t c = i_plane * n_columns; c < (i_plane + 1) * n_columns; ++c) {
      const double per_velocity = *density * (1 - double{fraction[c]}) * view.mesh.volume[c] /
                                  (edges[i_plane].high - edges[i_plane].low);
      flow += per_velocity * gas[c];
      response += per_velocity * variance(c) * (1 - double{fraction[c]});
    }
    if (!(response > 0)) continue;
    for (std::size_t c = i_plane * n_columns; c < (i_plane + 1) * n_columns; ++c) {
      const double after = gas[c] + (target - flow) / response * variance(c) * (1 - double{fraction[c]});
      change.add(gas[c], after, view.mesh.volume[c]);
      gas[c] = static_cast<float>(after);
    }
    ++result.n_planes_balanced;
  }
  result.gas_velocity_rms = change.rms();
  result.gas_velocity_relative = change.relative();
}

}  // namespace

ConservationChange conserve(const CaseView& view, std::span<float> values, std::span<const float> scale,
                            const AuditSettings& settings) {
  check(values.size() == view.fields.size() * view.mesh.n_cells(), "conserve: values must be fields x cells");
  check(scale.empty() || scale.size() == values.size(), "conserve: scale must have the shape of values");
  ConservationChange result;
  conserve_solids(view, values, scale, settings, result);
  conserve_gas(view, values, scale, settings, result);
  return result;
}

std::string to_text(const ConservationChange& change) {
  std::string text;
  if (change.solids_kg)
    text += fmt::format(
        "solids added        {:>+9.2f} t; volume fraction changed by {:.2g} (rms), {:.2g} % of it\n",
        *change.solids_kg / 1000, change.volume_fraction_rms, 100 * change.volume_fraction_relative);
  if (change.n_planes_balanced == 0)
    return text + "gas flow            no plane has a balance; not changed\n";
  return text + fmt::format(
                    "gas flow            balanced in {} planes; velocity z changed by {:.2g} m/s (rms), "
                    "{:.2g} % of it\n",
                    change.n_planes_balanced, change.gas_velocity_rms, 100 * change.gas_velocity_relative);
}

}  // namespace elrom::model
