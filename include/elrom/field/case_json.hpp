#pragma once
// One case as a JSON text gives it: {"case": ..., "load": ..., "inputs": {"primary_air [kg/s]": 161.1, ...}},
// by the rules of read_cases(). For those who get cases from elsewhere than from files.
//
// Thread rule: pure functions.

#include <string>
#include <string_view>

#include "elrom/field/boundary_conditions.hpp"

namespace elrom::field {

/// @param where for messages: what the text is of
/// @throws InputError as read_cases()
[[nodiscard]] CaseInputs parse_case(const std::string& json, const std::string& where,
                                    const InputSchema& schema);

/// The schema that such a case declares itself, by its inputs' names and units, in alphabetical order.
/// @throws InputError for an unknown unit, a name that appears twice
[[nodiscard]] InputSchema declared_schema(const std::string& json, const std::string& where);

}  // namespace elrom::field
