#pragma once

#include <cstdint>
#include <vector>

#include "elrom/field/mesh.hpp"
#include "elrom/field/planes.hpp"

namespace elrom::test {

/// Some planes of a mesh, with all its points, as a bundle gives them.
inline field::Mesh mesh_part(const field::Mesh& whole, const field::Planes& asked) {
  const auto planes = asked.numbers(whole.n_planes);
  auto part = whole;
  part.n_planes = planes.size();
  part.centre.resize(static_cast<Eigen::Index>(part.n_cells()), 3);
  part.volume.clear();
  part.corners.clear();
  for (std::size_t i = 0; i < part.n_cells(); ++i) {
    const auto cell =
        static_cast<std::size_t>(planes[i / part.n_columns]) * part.n_columns + i % part.n_columns;
    part.centre.row(static_cast<Eigen::Index>(i)) = whole.centre.row(static_cast<Eigen::Index>(cell));
    part.volume.push_back(whole.volume[cell]);
    for (std::size_t k = 0; k < 8; ++k) part.corners.push_back(whole.corners[cell * 8 + k]);
  }
  return part;
}

}  // namespace elrom::test
