#pragma once
// Cases as read, brought to a reduced mesh with the inputs and fields of a store.

#include <memory>
#include <stop_token>
#include <vector>

#include "elrom/ingest/case_summary.hpp"
#include "elrom/ingest/cfd_case.hpp"

namespace elrom::ingest {

/// Keeps the operators between one CFD mesh and the reduced mesh while the cases bring the same mesh.
/// Thread rule: one thread at a time.
class OntoMesh {
 public:
  /// @param mesh kept by reference
  OntoMesh(const field::Mesh& mesh, int n_threads, const std::stop_token& stop = {});
  ~OntoMesh();

  /// @throws InputError for a mesh that lies elsewhere, a boundary condition that is missing or unknown (with
  ///         the nearest name), a missing field, another unit
  [[nodiscard]] field::Snapshot bring(const CfdCase& one, const field::InputSchema& schema,
                                      const std::vector<field::FieldInfo>& fields);

  // Of the last case brought:
  [[nodiscard]] Coverage coverage() const;
  /// Reduced cells outside the hull of the CFD's cell centres.
  [[nodiscard]] std::size_t n_outside() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace elrom::ingest
