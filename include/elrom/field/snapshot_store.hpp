#pragma once
// Snapshot store `snapshots.h5`: cases x fields on the reduced mesh, with boundary conditions and provenance.
// Layout in data/FORMATS.md (kind "elrom-snapshots"). One dataset a field, chunked by case, so that one field
// of all cases streams without touching the rest.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/catalogue.hpp"
#include "elrom/field/furnace.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::field {

/// What a store knows of a case beside its fields.
struct CaseRecord {
  CaseInputs inputs;
  std::string source;         ///< file name it was read from
  std::string source_digest;  ///< SHA-256 of that file
  double averaging_window_s = 0;
  std::vector<double> resampling_error;  ///< of going to the reduced mesh and back: rms over the field's
                                         ///< standard deviation, (n_fields); empty: not resampled
  std::string content_digest;  ///< SHA-256 of the fields on the reduced mesh; the writer fills it in
};

/// A case on the reduced mesh, on its way into a store.
struct Snapshot {
  CaseRecord record;
  MatrixF fields;  //!< (n_fields, n_cells), in the store's field order, SI
};

/// Read access. Thread rule: one thread at a time (the HDF5 library has one lock).
class SnapshotStore {
 public:
  /// Reads the whole file in a child process first (io::survive).
  /// @throws InputError when it is no store, of a newer major format, or broken anywhere
  [[nodiscard]] static SnapshotStore open(const std::filesystem::path& path);
  SnapshotStore(SnapshotStore&&) noexcept;
  SnapshotStore& operator=(SnapshotStore&&) noexcept;
  ~SnapshotStore();

  [[nodiscard]] std::size_t n_cases() const;
  [[nodiscard]] const Mesh& mesh() const;
  [[nodiscard]] const InputSchema& schema() const;
  /// Nothing: nobody described it (or the store is older than that).
  [[nodiscard]] const std::optional<Furnace>& furnace() const;
  /// Within what the furnace allows, where there is one.
  [[nodiscard]] const std::vector<FieldInfo>& fields() const;
  [[nodiscard]] const std::vector<CaseRecord>& cases() const;
  /// Indices of cases whose name matches the pattern (shell style). Empty when none does.
  [[nodiscard]] std::vector<std::size_t> find(std::string_view pattern) const;
  /// SI, (cases.size(), n_inputs).
  [[nodiscard]] MatrixD inputs(std::span<const std::size_t> cases) const;
  /// One field of some cases, (cases.size(), n_cells), SI; streams case by case. @throws InputError
  /// (checksum, name)
  [[nodiscard]] MatrixF read(std::string_view field, std::span<const std::size_t> cases) const;
  /// SHA-256 over names, inputs and per-case content digests: the store's identity for study stages.
  [[nodiscard]] std::string digest(std::span<const std::size_t> cases) const;
  [[nodiscard]] const std::filesystem::path& path() const;

 private:
  struct Impl;
  static SnapshotStore open_here(const std::filesystem::path& path);
  explicit SnapshotStore(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Creates a store or adds cases to one, as a new file that replaces the old one at commit(): a crash or an
/// error before leaves the old store untouched. Holds the store's lock.
class SnapshotWriter {
 public:
  /// New store at `path` (nothing there yet), or, with the same mesh, schema and fields, an addition to the
  /// one there. @param furnace takes an earlier one's place; nothing: what is there stays
  /// @throws InputError "store of another mesh" / schema /
  /// field list, with both digests or the first difference
  SnapshotWriter(const std::filesystem::path& path, const Mesh& mesh, const InputSchema& schema,
                 const std::vector<FieldInfo>& fields, const std::optional<Furnace>& furnace = std::nullopt);
  ~SnapshotWriter();
  /// @throws InputError for a second case of the same name, or of the same content under another name
  void add(const Snapshot& snapshot);
  /// Takes cases out again that this writer added: what is left is written anew, as if they had never come.
  void leave_out(const std::set<std::string>& names);
  void commit();

 private:
  friend void remove_cases(const std::filesystem::path&, const std::set<std::string>&);
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// The store without these cases, as a new file that replaces the old one whole, or not at all; its bytes are
/// those of a store that never had them. Names that are not there change nothing. Holds the store's lock.
/// @throws InputError when it is no store or a case that stays cannot be read; the store is then as it was
void remove_cases(const std::filesystem::path& path, const std::set<std::string>& names);

}  // namespace elrom::field
