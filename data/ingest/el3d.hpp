#pragma once
// The mesh of an EL3D export, without its fields.

#include "elrom/ingest/cfd_case.hpp"
#include "elrom/io/hdf5.hpp"

namespace elrom::ingest {

/// Fills centre and volume; a file without volumes leaves them empty. @throws InputError
void read_el3d_mesh(const io::Hdf5File& file, CfdCase& one);

}  // namespace elrom::ingest
