#pragma once
// CFD results into a snapshot store: read, checked, resampled, appended; all files of a call or none.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {

struct ImportOptions {
  std::filesystem::path mesh;                ///< the reduced mesh; not needed to add to a store
  std::filesystem::path store;               ///< created, or added to
  std::vector<std::filesystem::path> files;  ///< in the order in which they enter the store
  std::filesystem::path cases;  ///< table of boundary conditions, for formats that carry none; may be empty
  std::vector<std::string> fields;  ///< of a new store; empty: the nine standard fields
  int n_threads = 1;
  /// Called for every case as read; throws to refuse it, gives
  /// false to leave it out. Empty: every case is taken.
  std::function<bool(const CfdCase&)> accept = {};
  /// Sees every case as it enters the store, on the reduced mesh. Empty: nobody looks.
  std::function<void(const field::Snapshot&, const field::Mesh&, const field::InputSchema&,
                     std::span<const field::FieldInfo>)>
      watch = {};
  /// Called once before the store is replaced; throws to leave it as it was.
  std::function<void()> confirm = {};
};

struct ImportSummary {
  std::vector<field::FieldInfo> fields;
  std::vector<double> mean_error, largest_error;  ///< of resampling, there and back, (n_fields)
  std::size_t n_added = 0, n_cases = 0;           ///< by this call; in the store now
  std::size_t n_outside = 0, n_cells = 0;  ///< reduced cells outside the hull of the last case's cell centres
};

/// Memory: one case at a time. The same files give the same bytes.
/// @throws InputError naming file and dataset, InputError for a store of another mesh, a second case of one
///         name or content, a boundary condition that is missing or unknown (with the nearest name), a
///         missing field; Interrupted. The store is then as it was.
ImportSummary import_cases(const ImportOptions& options, Log& log, const std::stop_token& stop = {});

}  // namespace elrom::ingest
