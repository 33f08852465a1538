#include "audit_planes.hpp"

#include <cmath>

#include "elrom/base/text.hpp"

namespace elrom::model::audit_detail {
namespace {

// Faces halfway between plane centres; the outermost planes are taken as thick as their inner halves.
std::vector<PlaneEdges> edges_from_centres(const field::Mesh& mesh) {
  const auto heights = mesh.plane_heights();
  const std::size_t n = heights.size();
  std::vector<PlaneEdges> edges(n);
  if (n == 1) return {{heights[0] - 0.5, heights[0] + 0.5}};
  for (std::size_t i = 0; i + 1 < n; ++i)
    edges[i].high = edges[i + 1].low = 0.5 * (heights[i] + heights[i + 1]);
  edges.front().low = 2 * heights.front() - edges.front().high;
  edges.back().high = 2 * heights.back() - edges.back().low;
  return edges;
}

}  // namespace

std::optional<std::size_t> find_field(const CaseView& view, std::string_view name) {
  for (std::size_t f = 0; f < view.fields.size(); ++f)
    if (view.fields[f].name == name) return f;
  return std::nullopt;
}

std::span<const float> cells_of(const CaseView& view, std::string_view name) {
  const auto f = find_field(view, name);
  return f ? view.values.subspan(*f * view.mesh.n_cells(), view.mesh.n_cells()) : std::span<const float>{};
}

std::optional<double> input_value(const CaseView& view, std::string_view name) {
  for (std::size_t i = 0; i < view.schema.size(); ++i)
    if (view.schema[i].name == name) return view.inputs[i];
  return std::nullopt;
}

std::vector<PlaneEdges> plane_edges(const field::Mesh& mesh) {
  if (mesh.corners.size() != mesh.n_cells() * 8) return edges_from_centres(mesh);
  std::vector<PlaneEdges> edges(mesh.n_planes);
  for (std::size_t i_plane = 0; i_plane < mesh.n_planes; ++i_plane) {
    double sums[2] = {0, 0};  // of the four lower and the four upper corners
    for (std::size_t i = i_plane * mesh.n_columns * 8; i < (i_plane + 1) * mesh.n_columns * 8; ++i)
      sums[i % 8 / 4] += mesh.points(mesh.corners[i], 2);
    edges[i_plane] = {sums[0] / (4.0 * mesh.n_columns), sums[1] / (4.0 * mesh.n_columns)};
    if (!(edges[i_plane].high > edges[i_plane].low)) return edges_from_centres(mesh);  // cells are points
  }
  return edges;
}

std::optional<double> gas_density(const CaseView& view, const AuditSettings& settings) {
  const auto temperature = input_value(view, "gas_temperature");
  if (!temperature || !(*temperature > 0)) return std::nullopt;
  return settings.ambient_pressure / (settings.gas_constant * *temperature);
}

double inflow_below(const CaseView& view, const AuditSettings& settings, const PlaneEdges& plane) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  constexpr double touch = 1e-6;  // [m]: faces that only touch a plane's face do not lie beside it
  // Cell averages feel an opening in the plane next to it
  // too: one plane's height is left free on either side.
  const double margin = plane.high - plane.low;
  if (settings.inlets.empty() || plane.high + margin > settings.outlet_low_m + touch) return none;
  double flow = 0;
  bool any = false;
  for (const auto& inlet : settings.inlets) {
    const double settled = inlet.high_m + margin;
    for (std::size_t i = 0; i < view.schema.size(); ++i) {
      if (view.schema[i].unit != "kg/s" || !base::matches(view.schema[i].name, inlet.inputs)) continue;
      if (plane.low + touch >= settled) {
        flow += view.inputs[i];
        any = true;
      } else if (plane.high + margin > inlet.low_m + touch) {
        return none;
      }
    }
  }
  return any ? flow : none;
}

}  // namespace elrom::model::audit_detail
