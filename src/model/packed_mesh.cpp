#include "packed_mesh.hpp"

#include "elrom/io/hdf5.hpp"

namespace elrom::model {
namespace {

constexpr std::uint8_t vtk_hexahedron = 12;
constexpr std::size_t n_corners = 8;

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
  std::vector<std::int32_t> offsets;
  for (std::size_t i = 0; i <= mesh.n_cells(); ++i)
    offsets.push_back(static_cast<std::int32_t>(i * n_corners));
  save_chunk<float>(file, "centre", single_precision(mesh.centre));
  save_chunk<float>(file, "points", single_precision(mesh.points));
  save_chunk<std::int32_t>(file, "connectivity", mesh.corners);
  save_chunk<std::int32_t>(file, "offsets", offsets);
  save_chunk<std::uint8_t>(file, "types", std::vector<std::uint8_t>(mesh.n_cells(), vtk_hexahedron));
}

}  // namespace elrom::model
