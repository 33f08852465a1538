#pragma once
// What no furnace can have, told by unit and name: a mass flow or mass below zero, a fraction outside 0 to 1,
// a spread or ratio below zero, a size, density or absolute temperature that is not above zero, and numbers
// beyond anything built.

#include "elrom/field/boundary_conditions.hpp"

namespace elrom::field {

/// @throws InputError naming case and input, in the user's unit
void check_possible(const CaseInputs& inputs, const InputSchema& schema);

}  // namespace elrom::field
