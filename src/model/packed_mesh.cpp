#include "packed_mesh.hpp"

#include "elrom/io/hdf5.hpp"
#include "elrom/io/vtkhdf.hpp"

namespace elrom::model {
namespace {

template <class T>
void save_chunk(io::TensorFile& file, const std::string& name, std::span<const T> values) {
  const auto chunk = io::pack_chunk(std::as_bytes(values), sizeof(T));
  file.set("mesh/packed/" + name, io::Tensor::copy(std::span<const std::uint8_t>(chunk), {chunk.size()}));
}

std::vector<float> single_precision(const MatrixD& values) {
  return {values.data(), values.data() + values.size()};
}

}  // namespace

void save_packed_mesh(io::TensorFile& file, const field::Mesh& mesh) {
  const io::VtkHexahedra grid(single_precision(mesh.points), mesh.corners);
  save_chunk<float>(file, "centre", single_precision(mesh.centre));
  save_chunk<float>(file, "points", grid.points);
  save_chunk<std::int32_t>(file, "connectivity", grid.connectivity);
  save_chunk<std::int32_t>(file, "offsets", grid.offsets);
  save_chunk<std::uint8_t>(file, "types", grid.types);
}

}  // namespace elrom::model
