#pragma once
// What the writers get: one case's results, and what all cases share.

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cells.hpp"
#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/io/tensor_file.hpp"
#include "elrom/model/audit.hpp"
#include "elrom/model/guard.hpp"

namespace elrom::fields {

/// The whole mesh as the bundle has it packed for HDF5.
struct PackedGeometry {
  io::Tensor centre, points, connectivity, offsets, types;
  std::size_t n_points = 0;
};

/// Shared by all cases of a run.
struct Run {
  std::vector<field::FieldInfo> fields;
  field::InputSchema schema;
  Cells cells;
  CellGeometry geometry;                 ///< empty for profiles, and where `packed` is enough
  std::optional<PackedGeometry> packed;  ///< set when all cells are written and the bundle has it
  std::optional<PlaneAverage> average;   ///< set: values are plane averages
  std::optional<double> level;           ///< set: half-widths are there
  std::string bundle_digest, mesh_digest, bundle_program, method;
  bool best_build_only = false;

  /// Values of one field in one case: cells, or planes with profiles.
  [[nodiscard]] std::size_t n_values() const { return average ? cells.planes.size() : cells.size(); }
};

/// One case. Thread rule: a plain view.
struct Prediction {
  const field::CaseInputs* inputs = nullptr;
  const model::Assessment* assessment = nullptr;
  std::span<const float> values;                      //!< SI, (fields, n_values)
  std::span<const float> half_width;                  //!< the same; empty without a level
  const model::Audit* audit = nullptr;                ///< of all cells as written; null: not asked for
  const model::ConservationChange* change = nullptr;  ///< what --conserve did; null: not asked for

  [[nodiscard]] std::span<const float> field(std::span<const float> all, const Run& run,
                                             std::size_t i) const {
    return all.subspan(i * run.n_values(), run.n_values());
  }
};

}  // namespace elrom::fields
