#pragma once
// Physics audit of predictions (--audit) and the repair that makes them conserve (--conserve).

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/fields/arguments.hpp"
#include "elrom/model/audit.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/cells.hpp"

namespace elrom::fields {

/// Of one case, as far as it was asked for.
struct PhysicsResult {
  std::optional<model::ConservationChange> change;
  std::optional<model::Audit> audit;  ///< of the values as they are written, so after a repair

  /// Indented lines, each after a line break, to follow the case's own line.
  [[nodiscard]] std::string text() const;
};

/// Thread rule: const use from any number of threads.
class Physics {
 public:
  /// @throws UsageError when cells, fields, inputs or the
  /// furnace are missing that the audit or the repair need
  Physics(const Arguments& arguments, const model::BundleReader& bundle, const model::Cells& cells);

  /// @param values all cells of the chosen fields; changed with --conserve. @throws NumericalError (the case
  /// has more solids than its furnace can hold)
  [[nodiscard]] PhysicsResult apply(const field::CaseInputs& inputs, std::span<float> values) const;

 private:
  bool audit_, conserve_;
  model::AuditSettings settings_;          ///< of the bundle's furnace
  std::vector<model::UsualFigure> usual_;  //!< empty: the bundle does not say
  field::Mesh mesh_;
  field::InputSchema schema_;
  std::vector<field::FieldInfo> fields_;  //!< chosen, in the bundle's order
};

}  // namespace elrom::fields
