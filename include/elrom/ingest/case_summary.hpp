#pragma once
// What the checks keep of a case: a few physical measures, a coarse sketch of its fields, and the cells that
// are wrong in themselves. Some kilobytes, whatever the mesh, so that hundreds of cases are compared with
// each other in memory.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/furnace.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::ingest {

/// How well the CFD's mesh and the reduced mesh lie on each other: shares of cells beyond the edge of the
/// other mesh by more than its cells' size, and their volumes.
struct Coverage {
  double uncovered = 0;  ///< of the reduced cells
  double beyond = 0;     ///< of the CFD's cells
  /// Of the CFD's cells over that of the reduced ones; NaN where one of them is not known.
  double volume = std::numeric_limits<double>::quiet_NaN();
};

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
  /// Of these centres and volumes, where cells come plane by plane; nullptr: no planes are known.
  const field::Mesh* mesh = nullptr;
  const field::Furnace* furnace = nullptr;        ///< nullptr: nobody described it
  std::optional<Coverage> coverage = {};          ///< nothing: not resampled here
  std::span<const double> resampling_error = {};  ///< (n_fields); empty: never resampled
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

/// One number of a case that physics bounds, or that the other cases bound.
struct Reading {
  std::string check;     ///< kind of the finding when it is out: "gas_balance"
  std::string quantity;  ///< field or input it tells about; may be empty
  std::string what;      ///< "gas flow between 7.8 and 40.6 m over the inlets' below"; the same in every case
  double value = 0;
  /// What physics allows, whatever the furnace; wide.
  double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
  /// Spread among other cases is taken to be at least this: of the value, or of its logarithm; infinite:
  /// physics alone judges.
  double least_spread = 0;
  bool logarithmic = false;  ///< other cases are compared by logarithms; value > 0
  /// Readings that are means of several scatter little, and are judged more closely: spreads from the other
  /// cases' middle that are usual, and the number of other cases that makes them twice as many.
  double reach = 7, few_cases = 20;
  bool only_above = false;  ///< no value is unlike the others by being small
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
  std::vector<Reading> readings;  //!< of every check that the case has the quantities for

  [[nodiscard]] double measure(Measure which) const { return measures[static_cast<std::size_t>(which)]; }
};

/// One pass over the case's cells; cells that are not finite are left out of every mean.
[[nodiscard]] CaseSummary summarise(const CheckedCase& view);

}  // namespace elrom::ingest
