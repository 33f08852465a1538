#pragma once
// The cases to predict: a table, some of its rows, changed by settings; or one case made of settings alone.

#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/fields/arguments.hpp"

namespace elrom::fields {

/// @throws UsageError (no such case, an input not given), InputError (the table)
[[nodiscard]] std::vector<field::CaseInputs> case_list(const Arguments& arguments,
                                                       const field::InputSchema& schema);

}  // namespace elrom::fields
