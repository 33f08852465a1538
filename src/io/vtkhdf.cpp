#include "elrom/io/vtkhdf.hpp"

#include <algorithm>

namespace elrom::io {
namespace {

// A cell whose corners are one point is shown as that point.
constexpr std::uint8_t vtk_hexahedron = 12, vtk_poly_vertex = 2;
constexpr std::size_t n_corners = 8;

Hdf5Group begin(const Hdf5Group& file, std::size_t n_points, std::size_t n_cells) {
  auto vtk = file.create_group("VTKHDF");
  const std::int64_t version[] = {1, 0};
  vtk.set_text("Type", "UnstructuredGrid");
  vtk.set_integers("Version", version);
  const auto count = [&](const char* name, std::size_t n) {
    const std::int64_t value[] = {static_cast<std::int64_t>(n)};
    vtk.write<std::int64_t>(name, value);
  };
  count("NumberOfPoints", n_points);
  count("NumberOfCells", n_cells);
  count("NumberOfConnectivityIds", n_cells * n_corners);
  return vtk;
}

}  // namespace

VtkHexahedra::VtkHexahedra(std::vector<float> points_of_cells, std::vector<std::int32_t> corners)
    : points(std::move(points_of_cells)), connectivity(std::move(corners)) {
  check(points.size() % 3 == 0 && connectivity.size() % n_corners == 0, "VTK grid: points and hexahedra");
  const std::size_t n = connectivity.size() / n_corners;
  offsets.resize(n + 1);
  for (std::size_t i = 0; i <= n; ++i) offsets[i] = static_cast<std::int32_t>(i * n_corners);
  types.assign(n, vtk_hexahedron);
  for (std::size_t i = 0; i < n; ++i) {
    const auto* cell = connectivity.data() + i * n_corners;
    if (std::all_of(cell, cell + n_corners, [&](std::int32_t point) { return point == *cell; }))
      types[i] = vtk_poly_vertex;
  }
}

Hdf5Group write_vtkhdf(const Hdf5Group& file, const VtkHexahedra& grid) {
  const auto vtk = begin(file, grid.n_points(), grid.n_cells());
  vtk.write<float>("Points", grid.points, {grid.n_points(), 3});
  vtk.write<std::int32_t>("Connectivity", grid.connectivity);
  vtk.write<std::int32_t>("Offsets", grid.offsets);
  vtk.write<std::uint8_t>("Types", grid.types);
  return vtk.create_group("CellData");
}

Hdf5Group write_vtkhdf(const Hdf5Group& file, const PackedVtkHexahedra& grid) {
  const auto vtk = begin(file, grid.n_points, grid.n_cells);
  vtk.write_packed<float>("Points", {grid.n_points, 3}, grid.points);
  vtk.write_packed<std::int32_t>("Connectivity", {grid.n_cells * n_corners}, grid.connectivity);
  vtk.write_packed<std::int32_t>("Offsets", {grid.n_cells + 1}, grid.offsets);
  vtk.write_packed<std::uint8_t>("Types", {grid.n_cells}, grid.types);
  return vtk.create_group("CellData");
}

void show_cell_data(const Hdf5Group& cell_data, const Hdf5Dataset& values, const std::string& target,
                    const std::string& name) {
  if (values.shape().size() == 1) {
    cell_data.hard_link(target, name);
  } else {
    cell_data.flat_view(values, name);
  }
}

}  // namespace elrom::io
