#pragma once
// A CFD result as exported, on the CFD's own mesh, before resampling.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "elrom/field/boundary_conditions.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/matrix.hpp"

namespace elrom::ingest {

struct CfdCase {
  field::CaseRecord record;    ///< inputs in `schema`'s order, SI
  field::InputSchema schema;   ///< empty when the format carries no boundary conditions
  MatrixD centre;              //!< cell centres [m], (n_cells, 3)
  std::vector<double> volume;  //!< [m3], (n_cells); empty when the format carries none
  std::vector<field::FieldInfo> fields;
  MatrixF values;  //!< SI, (n_fields, n_cells)
};

/// EL3D export, one HDF5 file a case (data/FORMATS.md, "EL3D export").
/// @throws InputError naming file and dataset: missing field, wrong unit, wrong shape, non-finite cell
[[nodiscard]] CfdCase read_el3d(const std::filesystem::path& path);
/// Fluent ASCII solution data (comma or space separated, optionally gzip); the case's name is the file's stem
/// and its boundary conditions come from a cases file.
[[nodiscard]] CfdCase read_fluent_ascii(const std::filesystem::path& path);
/// OpenFOAM case directory of an MPPICFoam run: averages instants
/// of gas and parcels (equations in the source file).
[[nodiscard]] CfdCase read_openfoam(const std::filesystem::path& directory);

/// What a simulation sent through a repository: a prediction file of all cells that names no bundle
/// (masters/foreign_program.hpp). @throws InputError for one that does: a model does not learn from its own
/// predictions
[[nodiscard]] CfdCase read_simulation(const std::filesystem::path& path);

/// By what is there: a directory with constant/polyMesh, an HDF5 file (an export, or a simulation sent
/// through a repository), or text.
[[nodiscard]] CfdCase read_case(const std::filesystem::path& path);

}  // namespace elrom::ingest
