#include <gmock/gmock.h>

#include "el3d_case.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/own_mesh.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"
#include "vtu_file.hpp"

namespace elrom::ingest {
namespace {

using ::testing::ElementsAre;

TEST(ReadCells, EachSourceIsToldByWhatIsThere) {
  const test::TemporaryFolder folder;
  test::El3dExport{}.write(folder / "a.h5");
  const auto vtu = read_cells(folder.write("a.vtu", test::VtuFile().text()));
  const auto table = read_cells(folder.write("a.csv", "x [mm],y,z,volume [m3]\n1000,2,3,4\n5000,6,7,8\n"));
  const auto foam = read_cells(ELROM_SOURCE_DIR "/data/formats/instants/case");

  EXPECT_EQ(vtu.centre.rows(), 4);
  EXPECT_EQ(table.centre, (MatrixD{{1, 2, 3}, {5, 6, 7}}));
  EXPECT_THAT(table.volume, ElementsAre(4, 8));
  EXPECT_TRUE(table.corners.empty());
  EXPECT_EQ(read_cells(folder / "a.h5").centre.rows(), 24);
  EXPECT_EQ(foam.corners.size(), 8 * static_cast<std::size_t>(foam.centre.rows()));
  EXPECT_ERROR(InputError, "folder holds no mesh", (void)read_cells(folder.path()));
}

TEST(ReadCells, ExportsWithoutVolumesHaveNone) {
  const test::TemporaryFolder folder;
  {
    auto file = io::Hdf5File::create(folder / "a.h5");
    const std::vector<double> centre{1, 2, 3, 4, 5, 6};
    file.create_group("mesh").write<double>("centre", centre, {2, 3}).set_text("unit", "mm");
    file.close();
  }

  const auto cells = read_cells(folder / "a.h5");

  EXPECT_DOUBLE_EQ(cells.centre(1, 2), 6e-3);
  EXPECT_TRUE(cells.volume.empty());
}

}  // namespace
}  // namespace elrom::ingest
