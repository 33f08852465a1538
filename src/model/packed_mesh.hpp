#pragma once
// The mesh as prediction files want it, packed once when a bundle is written; internal to model.

#include "elrom/field/mesh.hpp"
#include "elrom/io/tensor_file.hpp"

namespace elrom::model {

/// Puts the tensors "mesh/packed/{centre,points,connectivity,offsets,types}" (u8, chunks of io::pack_chunk).
void save_packed_mesh(io::TensorFile& file, const field::Mesh& mesh);

}  // namespace elrom::model
