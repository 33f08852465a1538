#pragma once
// What audit and conservation repair share: field lookup, plane thickness, gas density and gas balance.

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "elrom/model/audit.hpp"

namespace elrom::model::audit_detail {

/// Index of a field in the view; nullopt when it is not there.
std::optional<std::size_t> find_field(const CaseView& view, std::string_view name);
/// Cells of a field; empty when it is not there.
std::span<const float> cells_of(const CaseView& view, std::string_view name);
std::optional<double> input_value(const CaseView& view, std::string_view name);

struct PlaneEdges {
  double low = 0, high = 0;  ///< [m]
};
/// Lower and upper face of every plane: from the corner points,
/// or halfway between centres where there are none.
std::vector<PlaneEdges> plane_edges(const field::Mesh& mesh);

std::optional<double> gas_density(const CaseView& view, const AuditSettings& settings);
/// Gas mass flow that must pass the plane [kg/s]; NaN where an opening lies beside it.
double inflow_below(const CaseView& view, const AuditSettings& settings, const PlaneEdges& plane);

}  // namespace elrom::model::audit_detail
