#pragma once
// Audit and repair of a case as groups of its HDF5 file; layout in data/FORMATS.md (prediction).

#include "elrom/io/hdf5.hpp"
#include "elrom/model/audit.hpp"

namespace elrom::model {

/// Group "audit" of `parent`.
void write_audit(const Audit& audit, const io::Hdf5Group& parent);
/// Group "conservation" of `parent`.
void write_change(const ConservationChange& change, const io::Hdf5Group& parent);

}  // namespace elrom::model
