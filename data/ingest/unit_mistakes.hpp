#pragma once
// Unit mistakes: an input or a field that is out by just the
// factor (or offset) between two units of its dimension.
//
// Every logarithmic feature is regressed robustly (Theil 1950, Sen 1968) on the load, which is itself a
// median over the gas flows. A value is suspected when it lies far outside the scatter of the other cases and
// a change of unit would put it, and everything that depends on it, back among them. What no unit explains is
// told when an input lies far from what the other inputs make usual (model::OperatingLine, as in the guard),
// or a measure of the fields far from the other cases'. With too few cases for that, or when all of them
// share the mistake, the ratios that physics fixes still tell.

#include <span>
#include <string>
#include <vector>

#include "case_features.hpp"
#include "elrom/ingest/case_summary.hpp"

namespace elrom::ingest {

struct UnitMistake {
  std::size_t i_case = 0;
  std::string quantity;        ///< what is out; a list when physics alone cannot tell which
  std::string explanation;     ///< "values in t/h taken for kg/s", or the ratio that is impossible
  bool certain_cause = false;  ///< a change of unit explains it; else the value is only far out
};

/// Every correction that a slip between two units of the same dimension makes necessary, for inputs and
/// fields, one by one and together (all flows, all gas velocities ...).
[[nodiscard]] std::vector<Correction> possible_corrections(const field::InputSchema& schema,
                                                           std::span<const std::string> fields);

/// @param cases of one schema and one list of fields
[[nodiscard]] std::vector<UnitMistake> find_unit_mistakes(std::span<const CaseSummary> cases);

}  // namespace elrom::ingest
