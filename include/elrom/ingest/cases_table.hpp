#pragma once
// A table of boundary conditions (`--cases`) beside exports that carry none, or that are to agree with it.
//
// Thread rule: plain values.

#include <filesystem>
#include <string>
#include <vector>

#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {

/// The table, and the inputs that its headings declare.
struct CasesTable {
  std::string where;
  field::InputSchema schema;
  std::vector<field::CaseInputs> cases;
};
/// @throws InputError as field::read_cases
[[nodiscard]] CasesTable read_cases_table(const std::filesystem::path& path);

/// Boundary conditions from the table for a case that carries none; where both have them, they must agree to
/// 0.1 %.
/// @throws InputError when the table has no such case (with the nearest name), or says something else
void complete_inputs(CfdCase& one, const CasesTable& table);

}  // namespace elrom::ingest
