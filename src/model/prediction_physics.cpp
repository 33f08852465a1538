#include "prediction_physics.hpp"

#include <cmath>

namespace elrom::model {
namespace {

/// What is not known has no attribute.
void set_known(const io::Hdf5Object& object, const std::string& name, const std::optional<double>& value) {
  if (value && std::isfinite(*value)) object.set_number(name, *value);
}

void write_planes(const Audit& audit, const io::Hdf5Group& group) {
  const auto column = [&](const char* name, const char* unit, double PlaneAudit::*member) {
    std::vector<double> values;
    for (const auto& plane : audit.planes) values.push_back(plane.*member);
    group.write<double>(name, values).set_text("unit", unit);
  };
  column("height", "m", &PlaneAudit::height);
  column("area", "m2", &PlaneAudit::area);
  column("volume_fraction", "1", &PlaneAudit::volume_fraction);
  column("pressure", "Pa", &PlaneAudit::pressure);
  column("gas_flow", "kg/s", &PlaneAudit::gas_flow);
  column("gas_inflow", "kg/s", &PlaneAudit::gas_inflow);
  column("solid_flow", "kg/s", &PlaneAudit::solid_flow);
}

void write_bounds(const Audit& audit, const io::Hdf5Group& group) {
  std::vector<std::string> fields;
  std::vector<std::int64_t> n_outside, n_not_finite;
  std::vector<double> lowest, highest;
  for (const auto& bounds : audit.bounds) {
    fields.push_back(bounds.field);
    n_outside.push_back(static_cast<std::int64_t>(bounds.n_outside));
    n_not_finite.push_back(static_cast<std::int64_t>(bounds.n_not_finite));
    lowest.push_back(bounds.lowest);
    highest.push_back(bounds.highest);
  }
  group.set_texts("fields", fields);
  group.write<std::int64_t>("n_outside", n_outside);
  group.write<std::int64_t>("n_not_finite", n_not_finite);
  group.write<double>("lowest", lowest);
  group.write<double>("highest", highest);
}

}  // namespace

void write_audit(const Audit& audit, const io::Hdf5Group& parent) {
  const auto group = parent.create_group("audit");
  set_known(group, "solids_kg", audit.solids_kg);
  set_known(group, "inventory_kg", audit.inventory_kg);
  set_known(group, "gas_density_kg_per_m3", audit.gas_density);
  set_known(group, "gas_balance", audit.gas_balance);
  if (const auto* worst = audit.worst_gas_plane()) {
    group.set_integer("worst_gas_plane", worst - audit.planes.data());
    group.set_number("worst_gas_balance", worst->gas_flow / worst->gas_inflow);
  }
  if (const auto solids = audit.net_solid_flow()) {
    group.set_number("net_solid_flow_kg_per_s", solids->mean);
    group.set_number("net_solid_flow_lowest_kg_per_s", solids->lowest);
    group.set_number("net_solid_flow_highest_kg_per_s", solids->highest);
  }
  set_known(group, "pressure_drop_Pa", audit.pressure_drop);
  set_known(group, "solids_weight_Pa", audit.solids_weight);
  group.set_integer("within_bounds", audit.within_bounds() ? 1 : 0);
  if (!audit.unusual.empty()) group.set_texts("unusual", audit.unusual);
  write_planes(audit, group.create_group("planes"));
  write_bounds(audit, group.create_group("bounds"));
}

void write_change(const ConservationChange& change, const io::Hdf5Group& parent) {
  const auto group = parent.create_group("conservation");
  set_known(group, "solids_kg", change.solids_kg);
  group.set_number("volume_fraction_rms", change.volume_fraction_rms);
  group.set_number("volume_fraction_relative", change.volume_fraction_relative);
  group.set_number("gas_velocity_rms_m_per_s", change.gas_velocity_rms);
  group.set_number("gas_velocity_relative", change.gas_velocity_relative);
  group.set_integer("n_planes_balanced", static_cast<std::int64_t>(change.n_planes_balanced));
}

}  // namespace elrom::model
