#include "elrom/field/mesh.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/hexahedron.hpp"

namespace elrom::field {

std::string Mesh::digest() const {
  base::Sha256 hash;
  hash.add(std::string_view("elrom-mesh"));
  hash.add_value(static_cast<std::uint64_t>(n_planes)).add_value(static_cast<std::uint64_t>(n_columns));
  hash.add(std::as_bytes(std::span(centre.data(), static_cast<std::size_t>(centre.size()))));
  return hash.hex();
}

std::vector<double> Mesh::plane_heights() const {
  std::vector<double> heights(n_planes);
  const auto n = static_cast<Eigen::Index>(n_columns);
  for (std::size_t i = 0; i < n_planes; ++i) {
    heights[i] = centre.col(2).segment(static_cast<Eigen::Index>(i) * n, n).mean();
  }
  return heights;
}

namespace {

struct Lattice {
  std::size_t n_x, n_y, n_planes;
  [[nodiscard]] std::size_t point(std::size_t i, std::size_t j, std::size_t k) const {
    return i + (n_x + 1) * (j + (n_y + 1) * k);
  }
  [[nodiscard]] std::array<std::size_t, 8> corners(std::size_t i, std::size_t j, std::size_t k) const {
    return {point(i, j, k),     point(i + 1, j, k),     point(i + 1, j + 1, k),     point(i, j + 1, k),
            point(i, j, k + 1), point(i + 1, j, k + 1), point(i + 1, j + 1, k + 1), point(i, j + 1, k + 1)};
  }
};

MatrixD lattice_points(const TaperedFurnace& f, const Lattice& lattice) {
  MatrixD points(static_cast<Eigen::Index>((lattice.n_x + 1) * (lattice.n_y + 1) * (lattice.n_planes + 1)),
                 3);
  const auto share = [](std::size_t i, std::size_t n) {
    return static_cast<double>(i) / static_cast<double>(n);
  };
  for (std::size_t k = 0; k <= lattice.n_planes; ++k) {
    const double z = f.height_m * share(k, lattice.n_planes);
    const double grown = f.taper_height_m > 0 ? std::min(1.0, z / f.taper_height_m) : 1.0;
    const double width = f.bottom_width_m + (f.width_m - f.bottom_width_m) * grown;
    const double low = (f.width_m - width) / 2;
    for (std::size_t j = 0; j <= lattice.n_y; ++j) {
      for (std::size_t i = 0; i <= lattice.n_x; ++i) {
        const auto row = static_cast<Eigen::Index>(lattice.point(i, j, k));
        points(row, 0) = low + width * share(i, lattice.n_x);
        points(row, 1) = f.depth_m * share(j, lattice.n_y);
        points(row, 2) = z;
      }
    }
  }
  return points;
}

void expect_sane(const TaperedFurnace& f, std::size_t n_x, std::size_t n_y, std::size_t n_planes) {
  constexpr std::size_t most = 100'000'000;
  if (n_x < 1 || n_y < 1 || n_planes < 1)
    throw UsageError("a mesh needs at least one cell in each direction");
  if (n_x > most || n_y > most || n_planes > most || n_x * n_y > most || n_x * n_y * n_planes > most) {
    throw UsageError({.what = "too many cells", .expected = "at most " + std::to_string(most)});
  }
  for (const double length : {f.width_m, f.depth_m, f.height_m, f.bottom_width_m}) {
    if (!(length > 0) || !std::isfinite(length))
      throw UsageError("every length of a furnace must be positive");
  }
  if (!(f.taper_height_m >= 0)) throw UsageError("the taper's height must not be negative");
}

}  // namespace

Mesh make_furnace_mesh(const TaperedFurnace& furnace, std::size_t n_x, std::size_t n_y,
                       std::size_t n_planes) {
  expect_sane(furnace, n_x, n_y, n_planes);
  const Lattice lattice{n_x, n_y, n_planes};
  Mesh mesh{.n_planes = n_planes, .n_columns = n_x * n_y, .points = lattice_points(furnace, lattice)};
  mesh.centre.resize(static_cast<Eigen::Index>(mesh.n_cells()), 3);
  mesh.volume.reserve(mesh.n_cells());
  mesh.corners.reserve(8 * mesh.n_cells());
  for (std::size_t cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto corners = lattice.corners(cell % n_x, cell / n_x % n_y, cell / mesh.n_columns);
    std::array<Corner, 8> p;
    for (std::size_t c = 0; c < 8; ++c) {
      for (Eigen::Index i = 0; i < 3; ++i)
        p[c][static_cast<std::size_t>(i)] = mesh.points(static_cast<Eigen::Index>(corners[c]), i);
      mesh.corners.push_back(static_cast<std::int32_t>(corners[c]));
    }
    mesh.volume.push_back(hexahedron_volume(p));
    for (std::size_t i = 0; i < 3; ++i) {
      double sum = 0;
      for (const auto& corner : p) sum += corner[i];
      mesh.centre(static_cast<Eigen::Index>(cell), static_cast<Eigen::Index>(i)) = sum / 8;
    }
  }
  return mesh;
}

}  // namespace elrom::field
