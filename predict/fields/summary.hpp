#pragma once
// What a run found, a line a case: a table for spreadsheets, and curves over what was swept.

#include <span>
#include <string>
#include <vector>

#include "case_list.hpp"
#include "elrom/model/guard.hpp"

namespace elrom::fields {

/// Of one case. Thread rule: plain values.
struct CaseResult {
  model::Verdict verdict = model::Verdict::inside;
  std::string reason;
  double distance = 0;
  std::vector<double> figures;             ///< empty: not predicted (--strict)
  std::vector<std::string> unusual_audit;  ///< where it was audited: what training cases do not show
};

/// What the writers below share; everything is borrowed.
struct Summary {
  const field::InputSchema& schema;
  const CaseList& list;
  const std::vector<std::string>& figure_names;
  std::span<const CaseResult> results;  //!< (list.cases)
};

/// Cases whose audit is unusual where that of their base is not: all that differs is what a sweep moved
/// while the other inputs were held.
[[nodiscard]] std::size_t n_held_alone(const Summary& summary);

/// CSV: case, base, verdict, distance, reason (with what is unusual of an audit), held (of a sweep: whose
/// values the other inputs have), what was swept in the unit of the sweep, figures, and with bases the
/// change of each figure against the base's. Empty: not known.
[[nodiscard]] std::string summary_table(const Summary& summary);

/// A page for a browser, without a network: one chart a figure of `curves` and a swept input, a line for each
/// base and, of a grid, each combination of the other inputs.
[[nodiscard]] std::string curves_page(const Summary& summary, std::span<const std::size_t> curves);

}  // namespace elrom::fields
