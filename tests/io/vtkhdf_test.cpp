#include "elrom/io/vtkhdf.hpp"

#include <gmock/gmock.h>

#include "support/temporary_folder.hpp"

namespace elrom::io {
namespace {

using ::testing::ElementsAre;

/// Two unit cubes on top of each other.
VtkHexahedra two_cubes() {
  std::vector<float> points;
  for (int z = 0; z < 3; ++z)
    for (int k = 0; k < 4; ++k) points.insert(points.end(), {k % 2 + 0.0F, k / 2 + 0.0F, z + 0.0F});
  return {points, {0, 1, 3, 2, 4, 5, 7, 6, 4, 5, 7, 6, 8, 9, 11, 10}};
}

TEST(VtkHdf, HoldsTheGridAsVtkWantsIt) {
  const test::TemporaryFolder folder;
  const auto grid = two_cubes();
  {
    auto file = Hdf5File::create(folder / "a.hdf");
    static_cast<void>(write_vtkhdf(file, grid));
    file.close();
  }

  const auto vtk = Hdf5File::open(folder / "a.hdf").group("VTKHDF");

  EXPECT_EQ(vtk.text("Type"), "UnstructuredGrid");
  EXPECT_THAT(vtk.numbers("Version"), ElementsAre(1, 0));
  EXPECT_THAT(vtk.dataset("NumberOfPoints").read<std::int64_t>(), ElementsAre(12));
  EXPECT_THAT(vtk.dataset("NumberOfCells").read<std::int64_t>(), ElementsAre(2));
  EXPECT_THAT(vtk.dataset("NumberOfConnectivityIds").read<std::int64_t>(), ElementsAre(16));
  EXPECT_THAT(vtk.dataset("Points").shape(), ElementsAre(12, 3));
  EXPECT_EQ(vtk.dataset("Connectivity").read<std::int32_t>(), grid.connectivity);
  EXPECT_THAT(vtk.dataset("Offsets").read<std::int32_t>(), ElementsAre(0, 8, 16));
  EXPECT_THAT(vtk.dataset("Types").read<std::uint8_t>(), ElementsAre(12, 12));
}

TEST(VtkHdf, ACellWhoseCornersAreOnePointIsShownAsAPoint) {
  const VtkHexahedra grid({0, 0, 0, 1, 0, 0}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0, 1, 1, 0});

  EXPECT_THAT(grid.types, ElementsAre(2, 12));
}

TEST(VtkHdf, APackedGridReadsTheSame) {
  const test::TemporaryFolder folder;
  const auto grid = two_cubes();
  const auto pack = [](const auto& values) {
    return pack_chunk(std::as_bytes(std::span(values)), sizeof(values[0]));
  };
  const auto points = pack(grid.points), connectivity = pack(grid.connectivity), offsets = pack(grid.offsets),
             types = pack(grid.types);
  {
    auto file = Hdf5File::create(folder / "a.hdf");
    static_cast<void>(write_vtkhdf(file, PackedVtkHexahedra{points, connectivity, offsets, types, 12, 2}));
    file.close();
  }

  const auto vtk = Hdf5File::open(folder / "a.hdf").group("VTKHDF");

  EXPECT_EQ(vtk.dataset("Points").read<float>(), grid.points);
  EXPECT_EQ(vtk.dataset("Connectivity").read<std::int32_t>(), grid.connectivity);
  EXPECT_EQ(vtk.dataset("Offsets").read<std::int32_t>(), grid.offsets);
  EXPECT_EQ(vtk.dataset("Types").read<std::uint8_t>(), grid.types);
}

TEST(VtkHdf, CellDataIsOneRowOfTheSameValues) {
  const test::TemporaryFolder folder;
  {
    auto file = Hdf5File::create(folder / "a.hdf");
    const std::vector<float> values{1, 2};
    const auto table = file.write<float>("table", values, {2, 1}), row = file.write<float>("row", values);
    const auto cell_data = write_vtkhdf(file, two_cubes());
    show_cell_data(cell_data, table, "/table", "table");
    show_cell_data(cell_data, row, "/row", "row");
    file.close();
  }

  const auto cell_data = Hdf5File::open(folder / "a.hdf").group("VTKHDF/CellData");

  for (const char* name : {"table", "row"}) {
    EXPECT_THAT(cell_data.dataset(name).shape(), ElementsAre(2)) << name;
    EXPECT_THAT(cell_data.dataset(name).read<float>(), ElementsAre(1, 2)) << name;
  }
}

}  // namespace
}  // namespace elrom::io
