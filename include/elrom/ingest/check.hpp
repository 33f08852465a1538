#pragma once
// Suspicious data: what `elrom-data check` tells, and what import refuses or drops.

#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/field/snapshot_store.hpp"
#include "elrom/ingest/case_summary.hpp"
#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {

enum class Severity {
  note,        ///< worth knowing; nothing to do
  suspicious,  ///< may be right, and should be looked at
  wrong,       ///< cannot be right as it is: unreadable, not finite, a mistaken unit, a case twice
};
[[nodiscard]] std::string_view name_of(Severity severity);

struct Finding {
  std::string kind;  ///< "unreadable", "not_finite", "out_of_bounds", "unit", "far_input", "duplicate",
      ///< "near_duplicate", "outlier", "dead_cells", "dead_input", "other_layout", "mesh_cover",
      ///< "empty_field", "flow_direction", "continuity", "gas_balance", "solids_inventory", "roughness"
  Severity severity = Severity::suspicious;
  std::string case_name;   ///< empty: all cases
  std::string quantity;    ///< field or input
  std::int64_t cell = -1;  ///< first cell concerned; -1: none
  std::string message;     ///< one sentence, complete in itself
  // Where a number tells: it, and the range that it lies out of. NaN: no number.
  double value = std::numeric_limits<double>::quiet_NaN();
  double low = std::numeric_limits<double>::quiet_NaN(), high = std::numeric_limits<double>::quiet_NaN();
};

/// Kinds of findings on single cases: what `--accept` takes.
[[nodiscard]] const std::vector<std::string>& finding_kinds();

/// On the CFD's own mesh. @param planes of the same cells, see layers_of(); nullptr: none
[[nodiscard]] CheckedCase view_of(const CfdCase& one, const field::Mesh* planes = nullptr,
                                  const field::Furnace* furnace = nullptr);
/// The CFD's cells as planes, where the export has them layer by layer with as many cells in each.
[[nodiscard]] std::optional<field::Mesh> layers_of(const CfdCase& one);
/// @param fields (n_fields, n_cells); everything must outlive the view
[[nodiscard]] CheckedCase view_of(const field::CaseRecord& record, const MatrixF& values,
                                  const field::Mesh& mesh, const field::InputSchema& schema,
                                  std::span<const field::FieldInfo> fields,
                                  const field::Furnace* furnace = nullptr,
                                  std::optional<Coverage> coverage = std::nullopt);

/// Takes cases one after another and keeps a summary of each. Thread rule: one thread at a time.
class Checker {
 public:
  void add(const CheckedCase& view);
  /// Every case of a store; one case is resident at a time. A case whose checksum fails becomes a finding.
  void add(const field::SnapshotStore& store);
  /// A file that could not even be read.
  void add_unreadable(const std::string& name, const std::string& reason);

  /// Leaves cases out of every comparison but that of single cells (dead_cells).
  void forget(const std::set<std::string>& names);

  [[nodiscard]] const std::vector<CaseSummary>& cases() const { return cases_; }
  /// Everything found, worst first, in the order of the cases.
  [[nodiscard]] std::vector<Finding> findings() const;

 private:
  void add_dead_cells(std::vector<Finding>& found) const;

  std::vector<CaseSummary> cases_;
  std::vector<Finding> unreadable_;
  MatrixF lowest_, highest_;  //!< over the cases so far, (n_fields, n_cells); empty when the meshes differ
  bool same_mesh_ = true;
};

/// Findings on one of the cases that are at least suspicious.
[[nodiscard]] std::vector<Finding> findings_on(std::span<const Finding> findings, std::string_view case_name);

/// "{kind, format, program, cases, findings, counts}" (data/FORMATS.md, "check report").
[[nodiscard]] std::string to_json(const Checker& checker, std::span<const Finding> findings);
/// "suspicious: train_003, pressure: values in kPa taken for Pa"
[[nodiscard]] std::string line_of(const Finding& finding);

}  // namespace elrom::ingest
