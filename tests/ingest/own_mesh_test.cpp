#include "elrom/ingest/own_mesh.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "el3d_case.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/import.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"
#include "vtu_file.hpp"

namespace elrom::ingest {
namespace {

/// The cells of a mesh in another order.
CellSet shuffled(const field::Mesh& mesh) {
  std::vector<Eigen::Index> order(mesh.n_cells());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  CellSet cells{.points = mesh.points};
  cells.centre = mesh.centre(order, Eigen::all);
  for (const auto cell : order) {
    cells.volume.push_back(mesh.volume[static_cast<std::size_t>(cell)]);
    const auto* corners = mesh.corners.data() + 8 * cell;
    cells.corners.insert(cells.corners.end(), corners, corners + 8);
  }
  return cells;
}

void expect_equal(const field::Mesh& found, const field::Mesh& expected) {
  EXPECT_EQ(found.n_planes, expected.n_planes);
  EXPECT_EQ(found.n_columns, expected.n_columns);
  EXPECT_EQ(found.centre, expected.centre);
  EXPECT_EQ(found.volume, expected.volume);
  EXPECT_EQ(found.corners, expected.corners);
}

TEST(OwnMesh, TheTaperedFurnaceComesBackFromItsShuffledCells) {
  const auto furnace = field::make_furnace_mesh({}, 4, 6, 8);

  const auto own = group_into_planes(shuffled(furnace), {}, "a");

  EXPECT_TRUE(own.layered && own.has_volumes && own.has_corners);
  expect_equal(own.mesh, furnace);
}

/// Points in layers, each above another but for rounding. Two lie so near each other that rounding alone
/// decides which comes first in a row.
CellSet extruded_cloud() {
  const MatrixD place{{0.1, 0.2}, {0.7, 0.3}, {0.4, 0.9}, {0.1, 0.8}, {0.4, 0.900005}};
  CellSet cells;
  cells.centre.resize(15, 3);
  for (Eigen::Index i = 0; i < 15; ++i) {
    const Eigen::Index column = i % 5, plane = i * 7 % 3;
    const double rounding = column == 4 ? (plane == 1 ? -1e-9 : 1e-9) : 0;
    cells.centre.row(i) << place(column, 0) + rounding, place(column, 1),
        static_cast<double>(plane) + 1e-9 * static_cast<double>(i);
  }
  return cells;
}

TEST(OwnMesh, ColumnsOfACloudInLayersStandAboveEachOther) {
  const auto own = group_into_planes(extruded_cloud(), {}, "a");

  EXPECT_TRUE(own.layered);
  EXPECT_FALSE(own.has_volumes || own.has_corners);
  ASSERT_EQ(own.mesh.n_planes, 3U);
  for (Eigen::Index column = 0; column < 5; ++column) {
    for (Eigen::Index plane = 1; plane < 3; ++plane) {
      EXPECT_NEAR(own.mesh.centre(5 * plane + column, 0), own.mesh.centre(column, 0), 1e-6);
      EXPECT_NEAR(own.mesh.centre(5 * plane + column, 1), own.mesh.centre(column, 1), 1e-6);
    }
  }
  EXPECT_EQ(own.mesh.volume, std::vector<double>(15, 1));
  for (std::size_t i = 0; i < own.mesh.corners.size(); ++i)  // a point for each cell
    EXPECT_EQ(own.mesh.points.row(own.mesh.corners[i]),
              own.mesh.centre.row(static_cast<Eigen::Index>(i / 8)));
}

TEST(OwnMesh, WhatIsNotLayeredIsOnePlaneInTheSourcesOrder) {
  auto cells = extruded_cloud();
  cells.centre(3, 2) = 0.2;
  const auto centre = cells.centre;

  const auto own = group_into_planes(cells, {}, "a");

  EXPECT_FALSE(own.layered);
  EXPECT_EQ(own.mesh.n_planes, 1U);
  EXPECT_EQ(own.mesh.centre, centre);
  EXPECT_ERROR(InputError, "planes along z in a: found 4 of 1 to 5 cells, expected 3 of equally many",
               (void)group_into_planes(cells, {.n_planes = 3}, "a"));
  EXPECT_EQ(group_into_planes(cells, {.n_planes = 3, .tolerance_m = 0.3}, "a").mesh.n_planes, 3U)
      << "planes nearer than the tolerance are one";
}

TEST(OwnMesh, PlanesLieAcrossTheAxisThatIsAskedFor) {
  const auto furnace = field::make_furnace_mesh({.bottom_width_m = 10.6}, 4, 6, 8);

  const auto along_y = group_into_planes(shuffled(furnace), {.axis = 1}, "a");
  const auto one = group_into_planes(shuffled(furnace), {.n_planes = 1}, "a");

  EXPECT_EQ(along_y.mesh.n_planes, 6U);
  EXPECT_DOUBLE_EQ(along_y.mesh.centre.col(1).head(32).maxCoeff(), 27.6 / 12);
  EXPECT_EQ(one.mesh.n_planes, 1U);
  EXPECT_EQ(one.mesh.n_columns, 192U);
}

TEST(OwnMesh, NothingMakesNoMesh) {
  EXPECT_ERROR(InputError, "mesh without cells", (void)group_into_planes({}, {}, "a"));
}

/// Cases on a mesh of the user's: what comes in is what was exported, cell by cell.
class OwnMeshImport : public ::testing::Test {
 protected:
  void expect_exact(const field::Mesh& mesh) {
    field::write_mesh(options_.mesh, mesh);
    const auto summary = import_cases(options_, silent_log());

    EXPECT_THAT(summary.largest_error, ::testing::Each(0));
    EXPECT_EQ(summary.n_outside, 0U);
  }
  test::TemporaryFolder folder_;
  ImportOptions options_{.mesh = folder_ / "mesh.h5", .store = folder_ / "store.h5"};
};

TEST_F(OwnMeshImport, OfAnEl3dExportIsExact) {
  test::El3dExport one;
  one.write(folder_ / "a.h5");
  options_.files = {folder_ / "a.h5"};

  const auto own = group_into_planes(read_cells(folder_ / "a.h5"), {}, "a");
  expect_exact(own.mesh);

  const auto store = field::SnapshotStore::open(options_.store);
  const std::size_t first[] = {0};
  const auto values = store.read("pressure", first);
  EXPECT_EQ(store.mesh().n_planes, 4U);
  EXPECT_FLOAT_EQ(values(0, 0), 0.1F);
  EXPECT_FLOAT_EQ(values(0, 23), 0.123F);
}

TEST_F(OwnMeshImport, OfAnOpenFoamCaseIsExact) {
  options_.files = {ELROM_SOURCE_DIR "/data/formats/instants/case"};
  options_.cases = folder_.write("cases.csv", "case,speed [m/s]\ncase,1\n");

  const auto own = group_into_planes(read_cells(options_.files.front()), {}, "a");
  EXPECT_TRUE(own.layered && own.has_volumes && own.has_corners);
  expect_exact(own.mesh);

  EXPECT_EQ(field::SnapshotStore::open(options_.store).cases()[0].source, "case");
}

TEST_F(OwnMeshImport, OfATableWithItsOwnFieldsIsExactOnAFlatMesh) {
  std::string table = "x [m],y [m],z [m],velocity_x [m/s],heat flux [W]\n";
  for (int i = 0; i < 12; ++i)
    table += std::to_string(0.1 * (i % 4)) + ",0," + std::to_string(0.1 * (i / 4)) + "," +
             std::to_string(i * i) + "," + std::to_string(7 - i) + "\n";
  options_.files = {folder_.write("a.csv", table)};
  options_.cases = folder_.write("cases.csv", "case,speed [m/s]\na,1\n");
  options_.fields = {"velocity_x", "heat flux"};

  const auto own = group_into_planes(read_cells(options_.files.front()), {}, "a");
  EXPECT_EQ(own.mesh.n_planes, 3U);
  EXPECT_TRUE(own.has_volumes && own.has_corners);
  expect_exact(own.mesh);

  const auto store = field::SnapshotStore::open(options_.store);
  EXPECT_EQ(store.fields()[1].name, "heat flux");
  EXPECT_EQ(store.fields()[1].unit, "W");
  EXPECT_EQ(store.cases()[0].source, "a.csv");
}

TEST_F(OwnMeshImport, WithoutNamesOfFieldsSaysHowToNameThem) {
  options_.files = {folder_.write("a.csv", "x,y,z,velocity_x [m/s]\n0,0,0,1\n1,0,0,2\n")};
  options_.cases = folder_.write("cases.csv", "case,speed [m/s]\na,1\n");
  field::write_mesh(options_.mesh, group_into_planes(read_cells(options_.files.front()), {}, "a").mesh);

  EXPECT_ERROR(InputError, "--fields velocity_x", (void)import_cases(options_, silent_log()));
}

}  // namespace
}  // namespace elrom::ingest
