#pragma once
// A case in a few numbers: solids, gas balance and pressure drop as the audit tells
// them, and each field's mean, lowest and highest value over the cells asked for.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/model/audit.hpp"
#include "elrom/model/extent.hpp"
#include "elrom/model/predictor.hpp"

namespace elrom::fields {

/// Thread rule: const use from any number of threads.
class KeyFigures {
 public:
  KeyFigures(const model::Predictor& predictor, const model::Extent& extent);

  /// "pressure mean [Pa]"
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Whether a figure is worth a curve: all but the fields' ends.
  [[nodiscard]] bool is_curve(std::size_t i) const { return i < n_audit || (i - n_audit) % n_of_field == 0; }
  struct Figures {
    std::vector<double> values;        ///< (names().size()); NaN: fields, inputs or the furnace do not tell
    std::vector<std::string> unusual;  ///< mass and pressure that training cases do not show, a sentence each
  };
  /// @param values of the predictor
  [[nodiscard]] Figures of(const field::CaseInputs& inputs, std::span<const float> values) const;

 private:
  static constexpr std::size_t n_audit = 4, n_of_field = 3;

  [[nodiscard]] Figures audited(const field::CaseInputs& inputs, std::span<const float> values) const;

  const model::Predictor& predictor_;
  const model::Cells& cells_;
  field::Mesh mesh_;  //!< whole
  model::AuditSettings settings_;
  std::vector<std::string> names_;
};

}  // namespace elrom::fields
