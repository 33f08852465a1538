#pragma once
// Physics audit of a case or of a prediction: what the fields say about mass and pressure against what the
// boundary conditions say, plane by plane; and the smallest change that makes a prediction conserve.
//
// Assumptions, stated once: solids of one density (2400 kg/m3 in the shipped cases); gas is dry air of one
// density per case at ambient pressure and the case's gas_temperature (the EL3D solver is incompressible); a
// flux is the sum over a plane's cells of cell values, so the product of time averages stands for the average
// of the product.
//
// What is usual, the training cases say: their figures' mean and scatter (UsualFigure) are in the bundle.
//
// Non-goals: judging by physics. EL3D's own averages hold 94 to 101 % of the inventory and carry 90 to 103 %
// of the inlets' flow through the planes clear of openings (held-out shipped cases); compare a prediction
// with a case. For the same reason a repaired prediction conserves, but comes no nearer to EL3D's averages.
//
// Thread rule: pure functions.

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/furnace.hpp"
#include "elrom/field/mesh.hpp"

namespace elrom::model {

/// Fields that an audit reads; of others it looks at the bounds.
inline constexpr std::array audited_fields{"solid_volume_fraction", "gas_velocity_z", "pressure",
                                           "solid_velocity_z"};

struct AuditSettings {
  double solid_density = 2400;         ///< [kg/m3]
  double ambient_pressure = 101325;    ///< [Pa]
  double gas_constant = 287.05;        ///< dry air [J/(kg K)]
  double gravity = 9.80665;            ///< [m/s2]
  std::vector<field::Opening> inlets;  ///< empty: no gas balance
  /// Above it, gas leaves and no balance is drawn
  double outlet_low_m = std::numeric_limits<double>::infinity();
};

/// With the openings, the outlet and the solids of a furnace; nothing: without a gas balance.
[[nodiscard]] AuditSettings audit_settings(const std::optional<field::Furnace>& furnace);

/// One case's fields, borrowed: SI, field by field in the
/// order of `fields`, (fields.size() * mesh.n_cells()).
struct CaseView {
  const field::Mesh& mesh;
  const field::InputSchema& schema;
  std::span<const double> inputs;
  std::span<const field::FieldInfo> fields;
  std::span<const float> values;
};

/// A plane's averages; NaN where a needed field or input is missing.
struct PlaneAudit {
  double height = 0;           ///< [m]
  double area = 0;             ///< cell volumes over plane thickness [m2]
  double volume_fraction = 0;  ///< volume-weighted
  double pressure = 0;         ///< volume-weighted [Pa]
  double gas_flow = 0;         ///< upward [kg/s]
  double gas_inflow = 0;       ///< from all inlets below; NaN beside an inlet or the outlet [kg/s]
  double solid_flow = 0;       ///< net upward [kg/s]
};

struct BoundsAudit {
  std::string field;
  std::size_t n_outside = 0, n_not_finite = 0;
  double lowest = 0, highest = 0;
};

struct FlowRange {
  double lowest = 0, mean = 0, highest = 0;
};

struct Audit {
  std::optional<double> solids_kg;      ///< in the fields
  std::optional<double> inventory_kg;   ///< by the boundary conditions
  std::optional<double> gas_density;    ///< [kg/m3]
  std::optional<double> gas_balance;    ///< mean of gas_flow / gas_inflow over the planes that have a balance
  std::optional<double> pressure_drop;  ///< lowest minus highest plane [Pa]
  std::optional<double> solids_weight;  ///< weight over plane area, summed over planes [Pa]
  std::vector<PlaneAudit> planes;       //!< (n_planes), bottom first
  std::vector<BoundsAudit> bounds;      //!< (fields)
  /// "solids over inventory is 1.21: 0.99 +- 0.02 in 64 training cases"; see unusual_figures
  std::vector<std::string> unusual;
  [[nodiscard]] bool within_bounds() const;
  /// The plane whose gas flow misses the inlets' by the largest share; null when no plane has a balance.
  [[nodiscard]] const PlaneAudit* worst_gas_plane() const;
  /// Net upward solid flow over the planes clear of inlets and outlet [kg/s]; nothing when there are none. In
  /// a steady average it is the same in all of them: what the cyclones return.
  [[nodiscard]] std::optional<FlowRange> net_solid_flow() const;
};

[[nodiscard]] Audit audit(const CaseView& view, const AuditSettings& settings);
/// A figure of an audit as other cases have it.
struct UsualFigure {
  std::string name;  ///< "solids over inventory"
  double mean = 0, deviation = 0;
  std::size_t n_cases = 0;  ///< that tell it
};

/// Of solids over inventory, gas flow over the inlets', pressure drop over the weight of the solids: those
/// that three cases or more tell.
[[nodiscard]] std::vector<UsualFigure> usual_figures(std::span<const Audit> cases);
/// Sentences on figures farther than three deviations from the mean, as in Audit::unusual; empty: all usual.
[[nodiscard]] std::vector<std::string> unusual_figures(const Audit& audit,
                                                       std::span<const UsualFigure> usual);

/// A few lines for a terminal.
[[nodiscard]] std::string to_text(const Audit& audit);
/// JSON object, for files.
[[nodiscard]] std::string to_json(const Audit& audit);

/// Size of a repair, so that nobody takes it for free.
struct ConservationChange {
  std::optional<double> solids_kg;      ///< added to the fields to reach the inventory
  double volume_fraction_rms = 0;       ///< volume-weighted root mean square of the change
  double volume_fraction_relative = 0;  ///< the same over the field's root mean square
  double gas_velocity_rms = 0;          ///< [m/s]
  double gas_velocity_relative = 0;
  std::size_t n_planes_balanced = 0;
};
/// A few lines for a terminal.
[[nodiscard]] std::string to_text(const ConservationChange& change);

/// Changes `values` (layout of CaseView) as little as possible so that the solids sum to the input inventory
/// and, in every plane with a balance, the gas flow equals the inlets' below. "Little" is sum V (change /
/// scale)^2: the correction is scale^2 times one multiplier per constraint, held inside the bounds that
/// the view gives the volume fraction.
/// @param scale expected error of each value, same layout as values (e.g. conformal
///        half-widths); empty: the volume fraction itself, and 1 m/s. @throws
///        NumericalError when no fraction below the packing limit holds the inventory
ConservationChange conserve(const CaseView& view, std::span<float> values, std::span<const float> scale,
                            const AuditSettings& settings);

}  // namespace elrom::model
