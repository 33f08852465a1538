#pragma once
// What the checks keep of a case: a few physical measures, a coarse sketch of its fields, and the cells that
// are wrong in themselves. Some kilobytes, whatever the mesh, so that hundreds of cases are compared with
// each other in memory.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::ingest {

/// A case as the checks look at it, on any mesh; nothing is owned.
struct CheckedCase {
  std::string name;
  double load = std::numeric_limits<double>::quiet_NaN();
  const field::InputSchema* schema = nullptr;  ///< nullptr or empty: no inputs known
  std::span<const double> inputs;              ///< SI, (n_inputs)
  const MatrixD* centre = nullptr;             ///< [m], (n_cells, 3)
  std::span<const double> volume;              ///< [m3], (n_cells); empty: not known, cells count alike
  std::span<const field::FieldInfo> fields;
  ConstMapF values;  ///< SI, (n_fields, n_cells)
};

/// Positive numbers that a field's unit scales. NaN where a field or the volumes are missing.
enum class Measure {
  solid_x,
  solid_y,
  solid_z,  ///< root mean square of solid velocities
  gas_x,
  gas_y,
  gas_z,          ///< of gas velocities
  gas_rise,       ///< mean upward gas velocity between 0.5 and 0.8 of the height
  pressure_drop,  ///< mean pressure of the lowest tenth of the height less that of the highest
  diameter,       ///< solids' mean diameter, weighted by their volume
  solids_volume,  ///< sum of volume fraction * cell volume [m3]; of fraction alone without volumes
};
inline constexpr std::size_t n_measures = 10;
/// The field whose unit scales the measure.
[[nodiscard]] std::string_view field_of(Measure measure);

/// A cell that is wrong in itself.
struct BadCell {
  std::string field;
  std::int64_t cell = 0;  ///< first such cell
  double value = 0;
  std::int64_t count = 0;  ///< cells of this field that are wrong in the same way
};

struct CaseSummary {
  std::string name;
  double load = 0;
  field::InputSchema schema;
  std::vector<double> inputs;  //!< SI, (n_inputs)
  std::vector<std::string> fields;
  std::array<double, n_measures> measures{};
  double area = 0;    //!< mean horizontal cross-section [m2]
  double height = 0;  //!< [m]
  bool has_volume = false;
  MatrixF sketch;  //!< volume-weighted means in a coarse grid of boxes, (n_fields, n_boxes); 0 in empty boxes
  std::string digest;  //!< of the field values
  std::vector<BadCell> not_finite, out_of_bounds;

  [[nodiscard]] double measure(Measure which) const { return measures[static_cast<std::size_t>(which)]; }
};

/// One pass over the case's cells; cells that are not finite are left out of every mean.
[[nodiscard]] CaseSummary summarise(const CheckedCase& view);

}  // namespace elrom::ingest
