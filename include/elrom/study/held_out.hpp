#pragma once
// Cases that a study builds with and cases that it never looks at, and the file that says which are which.

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "elrom/field/snapshot_store.hpp"

namespace elrom::study {

/// Rows of a store: those a study may build with, and those it never looks at.
struct HeldOut {
  std::vector<std::size_t> building, held_out;
};
/// @param patterns names or shell patterns. @throws UsageError
/// when fewer than two cases are left to build with
[[nodiscard]] HeldOut hold_out(const std::vector<std::string>& names,
                               const std::vector<std::string>& patterns);
[[nodiscard]] HeldOut hold_out(const field::SnapshotStore& store, const std::vector<std::string>& patterns);

/// split.json of a study: names by part.
struct SplitNames {
  std::string by = "case";
  std::vector<std::string> train, validation, test, held_out;
};
void write_split(const std::filesystem::path& path, const SplitNames& split);
/// @throws InputError
[[nodiscard]] SplitNames read_split(const std::filesystem::path& path);

}  // namespace elrom::study
