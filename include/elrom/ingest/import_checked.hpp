#pragma once
// Import with the checks of check.hpp: new cases are compared with each other and with those of the store.

#include "elrom/ingest/check.hpp"
#include "elrom/ingest/import.hpp"

namespace elrom::ingest {

/// What import does with a case that cannot be right (Severity::wrong);
/// what is only suspicious is told as a warning.
enum class Policy { refuse, drop, keep };
/// @throws UsageError with the known names
[[nodiscard]] Policy policy_of(std::string_view name);

/// import_cases() with checks before the store is replaced.
/// @throws InputError with the first finding under Policy::refuse; the store is then as it was
ImportSummary import_checked(const ImportOptions& options, Policy policy, Log& log,
                             const std::stop_token& stop = {});

}  // namespace elrom::ingest
