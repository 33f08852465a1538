#pragma once
// Import with the checks of check.hpp: new cases are compared with each other and with those of the store.

#include "elrom/ingest/check.hpp"
#include "elrom/ingest/import.hpp"

namespace elrom::ingest {

/// What import does with a case that is wrong or suspicious (check.hpp).
enum class Policy { refuse, drop, keep };
/// @throws UsageError with the known names
[[nodiscard]] Policy policy_of(std::string_view name);

/// How new cases are judged.
struct Judgement {
  Judgement(Policy what_to_do, std::set<std::string> kinds = {})
      : policy(what_to_do), accepted(std::move(kinds)) {}
  Policy policy;
  std::set<std::string> accepted;  ///< kinds of findings that are told and change nothing (finding_kinds())
};
/// @throws UsageError for a kind that there is not, with the nearest
[[nodiscard]] std::set<std::string> accepted_kinds(const std::vector<std::string>& names);

/// import_cases() with checks before the store is replaced. Under Policy::drop, `options.refused` is told of
/// dropped cases too.
/// @throws InputError with the first finding under Policy::refuse; the store is then as it was
ImportSummary import_checked(const ImportOptions& options, const Judgement& judgement, Log& log,
                             const std::stop_token& stop = {});

}  // namespace elrom::ingest
