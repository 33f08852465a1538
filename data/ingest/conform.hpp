#pragma once
// A case as read, brought to the inputs and fields that a store holds.

#include <string>
#include <vector>

#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {

/// A table of cases (`--cases`) and the inputs that its headings declare.
struct CasesTable {
  std::string where;
  field::InputSchema schema;
  std::vector<field::CaseInputs> cases;
};
[[nodiscard]] CasesTable read_cases_table(const std::filesystem::path& path);

/// Boundary conditions from the table for a case that carries none; where both have them, they must agree to
/// 0.1 %.
/// @throws InputError when the table has no such case (with the nearest name), or says something else
void complete_inputs(CfdCase& one, const CasesTable& table);

/// Values in the order of `schema`. @throws InputError for an unknown (nearest name), missing or otherwise
/// measured input
[[nodiscard]] std::vector<double> conform_inputs(const CfdCase& one, const field::InputSchema& schema);

/// Rows of `fields`, in that order. @throws InputError for a missing field (nearest name) or another unit
[[nodiscard]] MatrixF conform_fields(const CfdCase& one, const std::vector<field::FieldInfo>& fields);

}  // namespace elrom::ingest
