#pragma once
// Physics at the door: what a case's fields say about themselves and about its boundary conditions, as a few
// numbers ("readings"). Each check is a file, physics_<name>.cpp, with its line in physics_checks.cpp; all of
// them are judged by one rule.
//
// Rule. A reading outside what physics allows is wrong. One outside the usual range of the other cases is
// suspicious: their median +- k s, with s the standard deviation by the median of their absolute deviations
// or by its 80th percentile, whichever is larger, and at least the reading's own least spread. Ranges of few
// cases are themselves uncertain: k is the reading's own (7 for most), grown for n other cases
// (model::growth_for_few), and below eight of them physics alone judges.

#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "elrom/ingest/case_summary.hpp"
#include "elrom/model/audit.hpp"

namespace elrom::ingest {

/// A case with what several checks share.
struct PhysicsView {
  const CheckedCase& one;
  std::optional<model::Audit> audit;  ///< nothing: no planes or no volumes

  /// Cells of a field; empty when it is not there.
  [[nodiscard]] std::span<const float> field(std::string_view name) const;
  /// Whether it is known to be a furnace that gas passes upward.
  [[nodiscard]] bool is_described() const { return one.furnace && !one.furnace->openings.empty(); }
  [[nodiscard]] double volume(std::size_t cell) const { return one.volume.empty() ? 1.0 : one.volume[cell]; }
  /// The same as a function.
  [[nodiscard]] auto weight() const {
    return [this](std::size_t cell) { return volume(cell); };
  }
};

/// The least spread of a reading that physics judges, and no other case.
inline constexpr double physics_alone = std::numeric_limits<double>::infinity();

// The checks. Each leaves out what the case lacks the quantities for.
[[nodiscard]] std::vector<Reading> read_gas_balance(const PhysicsView& view);
[[nodiscard]] std::vector<Reading> read_flow_direction(const PhysicsView& view);
[[nodiscard]] std::vector<Reading> read_solids_inventory(const PhysicsView& view);
[[nodiscard]] std::vector<Reading> read_mesh_cover(const PhysicsView& view);
[[nodiscard]] std::vector<Reading> read_roughness(const PhysicsView& view);
[[nodiscard]] std::vector<Reading> read_continuity(const PhysicsView& view);
[[nodiscard]] std::vector<Reading> read_empty_fields(const PhysicsView& view);

/// Readings of all checks; those that are not finite are left out.
[[nodiscard]] std::vector<Reading> read_physics(const CheckedCase& one);

struct PhysicsFinding {
  std::size_t i_case = 0;
  Reading reading;
  bool impossible = false;   ///< outside what physics allows; else unlike the other cases
  double low = 0, high = 0;  ///< the range that it lies out of
  std::size_t n_others = 0;  ///< cases that this range comes from; 0: physics
};

/// "gas flow ... is -0.97, in 72 other cases 0.9 to 1.03"
[[nodiscard]] std::string in_words(const PhysicsFinding& finding);

/// @param cases of one schema and one list of fields
[[nodiscard]] std::vector<PhysicsFinding> judge_physics(std::span<const CaseSummary> cases);

}  // namespace elrom::ingest
