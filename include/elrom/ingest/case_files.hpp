#pragma once
// What a path holds, found out without trusting it.

#include <filesystem>
#include <string>

namespace elrom::ingest {

/// By its first bytes, or by its ending: a damaged HDF5 file is better reported by the HDF5 reader than as a
/// strange text. @throws InputError when it cannot be read
[[nodiscard]] bool is_hdf5(const std::filesystem::path& path);

/// Attribute "kind" of an HDF5 file, empty without one. @throws InputError when it cannot be read, or crashes
/// the HDF5 library
[[nodiscard]] std::string kind_of(const std::filesystem::path& path);

/// An HDF5 file of kind "elrom-snapshots". @throws InputError
/// when it cannot be read, or crashes the HDF5 library
[[nodiscard]] bool is_snapshot_store(const std::filesystem::path& path);

/// Whether a text's first line has headings of an export (read_fluent_ascii), two at least: notes have none.
[[nodiscard]] bool begins_like_cells(const std::filesystem::path& path);

/// SHA-256 of a case: of its file, or of a directory's files with their names. @throws InputError
[[nodiscard]] std::string case_digest(const std::filesystem::path& path);

}  // namespace elrom::ingest
