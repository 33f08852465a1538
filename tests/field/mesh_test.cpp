#include "elrom/field/mesh.hpp"

#include <array>
#include <cmath>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::field {
namespace {

TEST(Mesh, CellsOfABoxHaveHandValues) {
  const auto mesh =
      make_furnace_mesh({.width_m = 2, .depth_m = 3, .height_m = 4, .bottom_width_m = 2}, 2, 3, 4);

  ASSERT_EQ(mesh.n_cells(), 24U);
  // Plane 1, column 1 + 2 * 2: the second cell in x, the third in y.
  const Eigen::Index cell = 6 + 5;
  EXPECT_NEAR(mesh.centre(cell, 0), 1.5, 1e-12);
  EXPECT_NEAR(mesh.centre(cell, 1), 2.5, 1e-12);
  EXPECT_NEAR(mesh.centre(cell, 2), 1.5, 1e-12);
  EXPECT_NEAR(mesh.volume[cell], 1.0, 1e-12);
}

TEST(Mesh, VolumeOfTheTaperedFurnaceIsExact) {
  const TaperedFurnace furnace;
  const auto mesh = make_furnace_mesh(furnace, 20, 42, 66);

  const double taper = (furnace.width_m + furnace.bottom_width_m) / 2 * furnace.taper_height_m;
  const double exact =
      (taper + furnace.width_m * (furnace.height_m - furnace.taper_height_m)) * furnace.depth_m;
  EXPECT_NEAR(std::accumulate(mesh.volume.begin(), mesh.volume.end(), 0.0), exact, 1e-9 * exact);
}

TEST(Mesh, ShippedMeshIsTheExactRefinementOfTheCfdMesh) {
  const auto fine = read_mesh(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.h5");
  const auto cfd = io::Hdf5File::open(ELROM_SOURCE_DIR "/data/cases/load_064.h5");
  const auto centre = cfd.dataset("mesh/centre").read<double>(),
             volume = cfd.dataset("mesh/volume").read<double>();
  ASSERT_EQ(volume.size() * 8, fine.n_cells());

  double worst_centre = 0, worst_volume = 0;
  for (std::size_t parent = 0; parent < volume.size(); ++parent) {
    const std::size_t i = parent % 10, j = parent / 10 % 21, k = parent / 210;
    double sum = 0;
    std::array<double, 3> mean{};
    for (std::size_t child = 0; child < 8; ++child) {
      const auto cell = (2 * k + child / 4) * 840 + (2 * i + child % 2) + 20 * (2 * j + child / 2 % 2);
      sum += fine.volume[cell];
      for (Eigen::Index d = 0; d < 3; ++d) mean[d] += fine.centre(static_cast<Eigen::Index>(cell), d) / 8;
    }
    for (std::size_t d = 0; d < 3; ++d)
      worst_centre = std::max(worst_centre, std::abs(mean[d] - centre[3 * parent + d]));
    worst_volume = std::max(worst_volume, std::abs(sum / volume[parent] - 1));
  }

  constexpr double float_rounding_m = 5e-6;  // the export keeps centres up to 47 m as float32
  EXPECT_LT(worst_centre, float_rounding_m);
  EXPECT_LT(worst_volume, 1e-5);
}

TEST(Mesh, ReadsBackWhatWasWritten) {
  test::TemporaryFolder folder;
  const auto mesh = make_furnace_mesh({}, 4, 6, 5);

  write_mesh(folder / "m.h5", mesh);
  const auto back = read_mesh(folder / "m.h5");

  EXPECT_EQ(back.digest(), mesh.digest());
  EXPECT_EQ(back.points, mesh.points);
  EXPECT_EQ(back.corners, mesh.corners);
  EXPECT_EQ(back.volume, mesh.volume);
  EXPECT_EQ(back.n_columns, 24U);
}

TEST(Mesh, DigestTellsMeshesApart) {
  EXPECT_NE(make_furnace_mesh({}, 4, 6, 5).digest(), make_furnace_mesh({}, 6, 4, 5).digest());
  EXPECT_NE(make_furnace_mesh({}, 4, 6, 5).digest(), make_furnace_mesh({.height_m = 48}, 4, 6, 5).digest());
}

TEST(Mesh, PlaneHeightsAreTheCentresOfEqualParts) {
  const auto heights = make_furnace_mesh({.height_m = 10, .bottom_width_m = 10.6}, 2, 2, 5).plane_heights();

  ASSERT_EQ(heights.size(), 5U);
  EXPECT_NEAR(heights[0], 1.0, 1e-12);
  EXPECT_NEAR(heights[4], 9.0, 1e-12);
}

TEST(Mesh, RefusesImpossibleSizes) {
  EXPECT_ERROR(UsageError, "at least one cell", make_furnace_mesh({}, 0, 1, 1));
  EXPECT_ERROR(UsageError, "too many cells", make_furnace_mesh({}, 100'000, 100'000, 100'000));
  EXPECT_ERROR(UsageError, "must be positive", make_furnace_mesh({.width_m = -1}, 1, 1, 1));
}

TEST(Mesh, DamagedMeshFilesAreNamed) {
  test::TemporaryFolder folder;
  write_mesh(folder / "m.h5", make_furnace_mesh({}, 2, 2, 2));
  auto file = io::Hdf5File::open(folder / "m.h5", io::Hdf5File::Access::edit);
  file.group("mesh").set_integer("n_planes", 3);
  file.close();

  EXPECT_ERROR(InputError, "m.h5:mesh/centre: found 8 x 3, expected 12 x 3", read_mesh(folder / "m.h5"));
}

}  // namespace
}  // namespace elrom::field
