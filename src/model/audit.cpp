#include "elrom/model/audit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "audit_planes.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::model {
namespace {

using namespace audit_detail;
constexpr double missing = std::numeric_limits<double>::quiet_NaN();

// Sum of weight(cell) over one plane.
template <class Weight>
double plane_sum(const field::Mesh& mesh, std::size_t i_plane, Weight weight) {
  double sum = 0;
  for (std::size_t cell = i_plane * mesh.n_columns; cell < (i_plane + 1) * mesh.n_columns; ++cell)
    sum += weight(cell);
  return sum;
}

struct AuditedFields {
  std::span<const float> fraction, pressure, gas_z, solid_z;
};

PlaneAudit audit_plane(const CaseView& view, const AuditSettings& settings, const AuditedFields& fields,
                       std::size_t i_plane, const PlaneEdges& edges, std::optional<double> density) {
  const auto& volume = view.mesh.volume;
  const double thickness = edges.high - edges.low;
  const double plane_volume = plane_sum(view.mesh, i_plane, [&](std::size_t c) { return volume[c]; });
  const auto over = [&](bool available, double divisor, auto integrand) {
    if (!available) return missing;
    return plane_sum(view.mesh, i_plane, [&](std::size_t c) { return integrand(c) * volume[c]; }) / divisor;
  };
  PlaneAudit plane;
  plane.height = 0.5 * (edges.low + edges.high);
  plane.area = plane_volume / thickness;
  plane.volume_fraction =
      over(!fields.fraction.empty(), plane_volume, [&](std::size_t c) { return double{fields.fraction[c]}; });
  plane.pressure =
      over(!fields.pressure.empty(), plane_volume, [&](std::size_t c) { return double{fields.pressure[c]}; });
  plane.gas_flow =
      over(density && !fields.gas_z.empty() && !fields.fraction.empty(), thickness,
           [&](std::size_t c) { return *density * (1 - double{fields.fraction[c]}) * fields.gas_z[c]; });
  plane.solid_flow = over(!fields.solid_z.empty() && !fields.fraction.empty(), thickness, [&](std::size_t c) {
    return settings.solid_density * double{fields.fraction[c]} * fields.solid_z[c];
  });
  plane.gas_inflow = inflow_below(view, settings, edges);
  return plane;
}

BoundsAudit audit_bounds(const field::FieldInfo& info, std::span<const float> cells) {
  BoundsAudit bounds{.field = info.name,
                     .lowest = std::numeric_limits<double>::infinity(),
                     .highest = -std::numeric_limits<double>::infinity()};
  for (const double value : cells) {
    if (!std::isfinite(value)) {
      ++bounds.n_not_finite;
      continue;
    }
    bounds.lowest = std::min(bounds.lowest, value);
    bounds.highest = std::max(bounds.highest, value);
    // Bounds as floats, like the cells: a cell clamped to 0.65F lies inside 0.65.
    const bool below = info.lower && value < static_cast<float>(*info.lower);
    const bool above = info.upper && value > static_cast<float>(*info.upper);
    if (below || above) ++bounds.n_outside;
  }
  return bounds;
}

void sum_solids(const CaseView& view, const AuditSettings& settings, const AuditedFields& fields,
                Audit& result) {
  if (fields.fraction.empty()) return;
  double mass = 0, weight = 0;
  for (std::size_t i_plane = 0; i_plane < view.mesh.n_planes; ++i_plane) {
    const double in_plane = settings.solid_density * plane_sum(view.mesh, i_plane, [&](std::size_t c) {
                              return double{fields.fraction[c]} * view.mesh.volume[c];
                            });
    mass += in_plane;
    weight += in_plane * settings.gravity / result.planes[i_plane].area;
  }
  result.solids_kg = mass;
  result.solids_weight = weight;
}

bool has_gas_balance(const PlaneAudit& plane) {
  return std::isfinite(plane.gas_inflow) && std::isfinite(plane.gas_flow) && plane.gas_inflow != 0;
}

std::optional<double> mean_gas_balance(const std::vector<PlaneAudit>& planes) {
  double sum = 0;
  int n = 0;
  for (const auto& plane : planes) {
    if (!has_gas_balance(plane)) continue;
    sum += plane.gas_flow / plane.gas_inflow;
    ++n;
  }
  return n > 0 ? std::optional(sum / n) : std::nullopt;
}

nlohmann::json json_or_null(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? nlohmann::json(*value) : nlohmann::json();
}

}  // namespace

AuditSettings audit_settings(const std::optional<field::Furnace>& furnace) {
  AuditSettings settings;
  if (!furnace) return settings;
  settings.solid_density = furnace->solid_density;
  settings.inlets = furnace->openings;
  settings.outlet_low_m = furnace->outlet_low_m;
  return settings;
}

bool Audit::within_bounds() const {
  return std::all_of(bounds.begin(), bounds.end(),
                     [](const BoundsAudit& b) { return b.n_outside == 0 && b.n_not_finite == 0; });
}

const PlaneAudit* Audit::worst_gas_plane() const {
  const PlaneAudit* worst = nullptr;
  const auto miss = [](const PlaneAudit& plane) { return std::abs(plane.gas_flow / plane.gas_inflow - 1); };
  for (const auto& plane : planes)
    if (has_gas_balance(plane) && (worst == nullptr || miss(plane) > miss(*worst))) worst = &plane;
  return worst;
}

std::optional<FlowRange> Audit::net_solid_flow() const {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  FlowRange range{.lowest = infinity, .mean = 0, .highest = -infinity};
  int n = 0;
  for (const auto& plane : planes) {
    if (!std::isfinite(plane.gas_inflow) || !std::isfinite(plane.solid_flow)) continue;
    range.lowest = std::min(range.lowest, plane.solid_flow);
    range.highest = std::max(range.highest, plane.solid_flow);
    range.mean += plane.solid_flow;
    ++n;
  }
  if (n == 0) return std::nullopt;
  range.mean /= n;
  return range;
}

Audit audit(const CaseView& view, const AuditSettings& settings) {
  const std::size_t n_cells = view.mesh.n_cells();
  check(view.values.size() == view.fields.size() * n_cells, "audit: values must be fields x cells");
  check(view.inputs.size() == view.schema.size(), "audit: inputs must follow the schema");
  check(view.mesh.volume.size() == n_cells, "audit: the mesh has no volumes");

  Audit result;
  result.gas_density = gas_density(view, settings);
  result.inventory_kg = input_value(view, "solids_inventory");
  const AuditedFields fields{.fraction = cells_of(view, "solid_volume_fraction"),
                             .pressure = cells_of(view, "pressure"),
                             .gas_z = cells_of(view, "gas_velocity_z"),
                             .solid_z = cells_of(view, "solid_velocity_z")};
  const auto edges = plane_edges(view.mesh);
  for (std::size_t i_plane = 0; i_plane < view.mesh.n_planes; ++i_plane)
    result.planes.push_back(audit_plane(view, settings, fields, i_plane, edges[i_plane], result.gas_density));
  sum_solids(view, settings, fields, result);
  result.gas_balance = mean_gas_balance(result.planes);
  if (!fields.pressure.empty() && !result.planes.empty())
    result.pressure_drop = result.planes.front().pressure - result.planes.back().pressure;
  for (std::size_t f = 0; f < view.fields.size(); ++f)
    result.bounds.push_back(audit_bounds(view.fields[f], view.values.subspan(f * n_cells, n_cells)));
  return result;
}

std::string to_text(const Audit& audit) {
  std::string text;
  if (audit.solids_kg)
    text += fmt::format("solids inventory    {:>9.2f} t in the fields", *audit.solids_kg / 1000);
  if (audit.solids_kg && audit.inventory_kg && *audit.inventory_kg != 0)
    text += fmt::format(", {:.2f} t asked for ({:+.1f} %)", *audit.inventory_kg / 1000,
                        100 * (*audit.solids_kg / *audit.inventory_kg - 1));
  if (audit.solids_kg) text += '\n';
  if (audit.gas_balance)
    text += fmt::format(
        "gas flow            {:>9.1f} % of the inlets' (mean over the planes between inlets and outlet)\n",
        100 * *audit.gas_balance);
  if (const auto* worst = audit.worst_gas_plane())
    text += fmt::format("worst plane         {:>9.1f} % of the inlets' at {:.1f} m ({:.1f} of {:.1f} kg/s)\n",
                        100 * worst->gas_flow / worst->gas_inflow, worst->height, worst->gas_flow,
                        worst->gas_inflow);
  if (const auto solids = audit.net_solid_flow())
    text += fmt::format("net solid flow      {:>9.1f} kg/s upward, {:.1f} to {:.1f} over the same planes\n",
                        solids->mean, solids->lowest, solids->highest);
  if (audit.pressure_drop && audit.solids_weight)
    text += fmt::format("pressure drop       {:>9.0f} Pa; weight of the solids {:.0f} Pa\n",
                        *audit.pressure_drop, *audit.solids_weight);
  for (const auto& figure : audit.unusual) text += "unusual             " + figure + '\n';
  if (audit.within_bounds())
    return text + "bounds              every field is finite and inside its physical bounds\n";
  for (const auto& b : audit.bounds)
    if (b.n_outside + b.n_not_finite > 0)
      text += fmt::format("bounds              {}: {} cells outside, {} not finite (lowest {}, highest {})\n",
                          b.field, b.n_outside, b.n_not_finite, base::rounded(b.lowest),
                          base::rounded(b.highest));
  return text;
}

std::string to_json(const Audit& audit) {
  nlohmann::ordered_json root;
  root["solids_kg"] = json_or_null(audit.solids_kg);
  root["inventory_kg"] = json_or_null(audit.inventory_kg);
  root["gas_density_kg_per_m3"] = json_or_null(audit.gas_density);
  root["gas_balance"] = json_or_null(audit.gas_balance);
  root["pressure_drop_Pa"] = json_or_null(audit.pressure_drop);
  root["solids_weight_Pa"] = json_or_null(audit.solids_weight);
  root["within_bounds"] = audit.within_bounds();
  root["unusual"] = audit.unusual;
  for (const auto& plane : audit.planes)
    root["planes"].push_back({{"height_m", plane.height},
                              {"area_m2", plane.area},
                              {"volume_fraction", json_or_null(plane.volume_fraction)},
                              {"pressure_Pa", json_or_null(plane.pressure)},
                              {"gas_flow_kg_per_s", json_or_null(plane.gas_flow)},
                              {"gas_inflow_kg_per_s", json_or_null(plane.gas_inflow)},
                              {"solid_flow_kg_per_s", json_or_null(plane.solid_flow)}});
  for (const auto& b : audit.bounds)
    root["bounds"].push_back({{"field", b.field},
                              {"n_outside", b.n_outside},
                              {"n_not_finite", b.n_not_finite},
                              {"lowest", json_or_null(b.lowest)},
                              {"highest", json_or_null(b.highest)}});
  return root.dump();
}

}  // namespace elrom::model
