#pragma once
// CFD results into a snapshot store: read, checked, resampled, appended; all files of a call or none.

#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/ingest/case_summary.hpp"
#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {

/// A case on its way into the store, on the reduced mesh; nothing is owned.
struct EnteringCase {
  const std::filesystem::path& file;
  const field::Snapshot& snapshot;
  const field::Mesh& mesh;
  const field::InputSchema& schema;
  std::span<const field::FieldInfo> fields;
  const field::Furnace* furnace;  ///< that the store carries from now on; nullptr: none
  Coverage coverage;
};

struct ImportOptions {
  std::filesystem::path mesh;   ///< the reduced mesh; not needed to add to a store
  std::filesystem::path store;  ///< created, or added to
  /// Furnace description; empty: the one beside the mesh, named as the mesh is (.toml), where there is one.
  std::filesystem::path furnace;
  std::vector<std::filesystem::path> files;  ///< in the order in which they enter the store
  std::filesystem::path cases;  ///< table of boundary conditions, for formats that carry none; may be empty
  std::vector<std::string> fields;  ///< of a new store; empty: the nine standard fields
  int n_threads = 1;
  /// Sees every case as it enters the store. Empty: nobody looks.
  std::function<void(const EnteringCase&)> watch = {};
  /// Told of every file that cannot be taken, and why; the others are taken without it. Empty: the first such
  /// file ends the import.
  std::function<void(const std::filesystem::path&, const std::string& reason)> refused = {};
  /// Called once before the store is replaced: names of the new cases that are not to stay. Throws to leave
  /// the store as it was. Empty: all stay.
  std::function<std::set<std::string>()> leave_out = {};
};

struct ImportSummary {
  std::vector<field::FieldInfo> fields;
  std::vector<double> mean_error, largest_error;  ///< of resampling, there and back, (n_fields)
  std::vector<std::string> added;                 ///< names, by this call
  std::size_t n_cases = 0;                        ///< in the store now
  std::size_t n_outside = 0, n_cells = 0;  ///< reduced cells outside the hull of the last case's cell centres
};

/// Memory: one case at a time; a file is read once. The same files give the same bytes.
/// An existing store keeps its furnace description, unless `furnace` names another; without files, that is
/// all that is done.
/// @throws InputError naming file and dataset, InputError for a store of another mesh, a second case of one
///         name or content, a boundary condition that is missing or unknown (with the nearest name), a
///         missing field, a furnace description that is wrong or not of these cases; Interrupted. The store
///         is then as it was.
ImportSummary import_cases(const ImportOptions& options, Log& log, const std::stop_token& stop = {});

}  // namespace elrom::ingest
