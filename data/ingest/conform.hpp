#pragma once
// A case as read, brought to the inputs and fields that a store holds.

#include <string>
#include <vector>

#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {

/// Values in the order of `schema`. @throws InputError for an unknown (nearest name), missing or otherwise
/// measured input
[[nodiscard]] std::vector<double> conform_inputs(const CfdCase& one, const field::InputSchema& schema);

/// Rows of `fields`, in that order. @throws InputError for a missing field (nearest name) or another unit
[[nodiscard]] MatrixF conform_fields(const CfdCase& one, const std::vector<field::FieldInfo>& fields);

}  // namespace elrom::ingest
