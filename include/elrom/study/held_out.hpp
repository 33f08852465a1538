#pragma once
// Cases that a study builds with, cases that it never looks at and cases that take no part, and the file that
// says which are which.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "elrom/field/snapshot_store.hpp"

namespace elrom::study {

/// Rows of a store: those a study may build with, those it never looks at, and those that take no part.
struct HeldOut {
  std::vector<std::size_t> building, held_out, excluded;
};
/// @param patterns, exclude names or shell patterns; a case that both name is excluded
/// @throws UsageError when fewer than two cases are left to build with
[[nodiscard]] HeldOut hold_out(const std::vector<std::string>& names,
                               const std::vector<std::string>& patterns,
                               const std::vector<std::string>& exclude = {});

[[nodiscard]] HeldOut hold_out(const field::SnapshotStore& store, const std::vector<std::string>& patterns,
                               const std::vector<std::string>& exclude = {});

/// @throws UsageError naming the setting, a pattern that no case matches, and the nearest name
void expect_matches(const field::SnapshotStore& store, const std::vector<std::string>& patterns,
                    const std::string& setting);

/// split.json of a study: names by part.
struct SplitNames {
  std::string by = "case";
  std::vector<std::string> train, validation, test, held_out;
  std::vector<std::string> excluded = {};  ///< since 1.1
};
void write_split(const std::filesystem::path& path, const SplitNames& split);
/// @throws InputError
[[nodiscard]] SplitNames read_split(const std::filesystem::path& path);

}  // namespace elrom::study
