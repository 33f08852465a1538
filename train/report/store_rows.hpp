#pragma once
// Cases that a study names, in a store that may have changed since the study was trained.

#include <cstddef>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/field/snapshot_store.hpp"

namespace elrom::report {

/// Names in the store that match, each once. @throws UsageError for a pattern that matches nothing
[[nodiscard]] std::vector<std::string> named_cases(const field::SnapshotStore& store,
                                                   const std::vector<std::string>& patterns);

/// Rows of cases to judge on. @throws InputError for one that the store does not hold, with the ways on
[[nodiscard]] std::vector<std::size_t> judging_rows(const field::SnapshotStore& store,
                                                    const std::vector<std::string>& names);

/// Rows of cases that a study learnt from; those that the store does not hold any more are told and left
/// out. @throws InputError when it holds none
[[nodiscard]] std::vector<std::size_t> learnt_rows(const field::SnapshotStore& store,
                                                   const std::vector<std::string>& names, Log& log);

}  // namespace elrom::report
