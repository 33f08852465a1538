#pragma once
// The unit in which a user gives and reads an input.

#include "elrom/base/units.hpp"
#include "elrom/field/boundary_conditions.hpp"

namespace elrom::field {

[[nodiscard]] inline const base::Unit& user_unit(const field::InputInfo& info) {
  return base::unit(info.display_unit.empty() ? info.unit : info.display_unit);
}

}  // namespace elrom::field
