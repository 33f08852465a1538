#pragma once
// The cases to predict: a table, some of its rows, changed by settings; or one case made of settings alone.

#include <vector>

#include "arguments.hpp"
#include "elrom/field/boundary_conditions.hpp"

namespace elrom::predict {

/// @throws UsageError (no such case, an input not given), InputError (the table)
[[nodiscard]] std::vector<field::CaseInputs> case_list(const Arguments& arguments,
                                                       const field::InputSchema& schema);

}  // namespace elrom::predict
