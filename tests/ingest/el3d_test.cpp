#include <gmock/gmock.h>

#include <functional>

#include "el3d_case.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/cfd_case.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::ingest {
namespace {

class El3d : public ::testing::Test {
 protected:
  CfdCase read(const test::El3dExport& one) const {
    one.write(path_);
    return read_el3d(path_);
  }
  void damage(const std::function<void(const io::Hdf5File&)>& change) const {
    const test::El3dExport whole;
    whole.write(path_);
    auto file = io::Hdf5File::open(path_, io::Hdf5File::Access::edit);
    change(file);
    file.close();
  }
  test::TemporaryFolder folder_;
  std::filesystem::path path_ = folder_ / "a.h5";
};

TEST_F(El3d, ReadsAShippedCase) {
  const auto one = read_el3d(ELROM_SOURCE_DIR "/data/cases/load_064.h5");

  EXPECT_EQ(one.record.inputs.name, "load_064");
  EXPECT_DOUBLE_EQ(one.record.inputs.load, 0.64);
  EXPECT_EQ(one.record.averaging_window_s, 24);
  EXPECT_EQ(one.record.source, "load_064.h5");
  EXPECT_EQ(one.centre.rows(), 6930);
  ASSERT_EQ(one.fields.size(), 9U);
  EXPECT_EQ(one.fields[6].name, "pressure");
  // As the table of cases lists them, in SI.
  EXPECT_NEAR(one.record.inputs.values[one.schema.index_of("primary_air")], 168.366, 1e-3);
  EXPECT_NEAR(one.record.inputs.values[one.schema.index_of("solids_inventory")], 107'961, 1);
  EXPECT_NEAR(one.record.inputs.values[one.schema.index_of("solids_d50")], 263.297e-6, 1e-9);
  EXPECT_NEAR(one.record.inputs.values[one.schema.index_of("gas_temperature")], 814.445 + 273.15, 1e-2);
}

TEST_F(El3d, ConvertsTheUnitsOfFields) {
  auto in_kpa = test::El3dExport{};
  in_kpa.pressure_unit = "kPa";

  EXPECT_NEAR(read(in_kpa).values(6, 0), 100, 1e-4);
}

TEST_F(El3d, RefusesAWrongUnit) {
  auto wrong = test::El3dExport{};
  wrong.pressure_unit = "K";

  EXPECT_ERROR(InputError, "a.h5:fields/pressure: found 'K', expected one of Pa", read(wrong));
}

TEST_F(El3d, NamesTheCellThatIsNotFinite) {
  auto wild = test::El3dExport{};
  wild.with_nan = true;

  EXPECT_ERROR(InputError, "a.h5:fields/pressure, cell 5: found nan", read(wild));
}

TEST_F(El3d, NamesTheDatasetOfAWrongShape) {
  damage([](const io::Hdf5File& file) {
    file.remove("mesh/volume");
    file.group("mesh").write<double>("volume", std::vector<double>(7, 1.0));
  });

  EXPECT_ERROR(InputError, "wrong shape in " + path_.string() + ":mesh/volume: found 7, expected 24",
               read_el3d(path_));
}

TEST_F(El3d, NamesWhatIsMissing) {
  damage([](const io::Hdf5File& file) { file.remove("boundary_conditions"); });
  EXPECT_ERROR(InputError, "missing dataset 'boundary_conditions'", read_el3d(path_));

  damage([](const io::Hdf5File& file) { file.dataset("fields/pressure").remove_attribute("unit"); });
  EXPECT_ERROR(InputError, "missing attribute 'unit'", read_el3d(path_));
}

TEST_F(El3d, RefusesCellsWithoutVolume) {
  damage([](const io::Hdf5File& file) {
    file.dataset("mesh/volume").write_slab<double>({3}, {1}, std::vector<double>{0});
  });

  EXPECT_ERROR(InputError, "mesh/volume, cell 3", read_el3d(path_));
}

TEST_F(El3d, RefusesTextWhereNumbersBelong) {
  damage([](const io::Hdf5File& file) {
    file.remove("fields/pressure");
    file.group("fields").write_texts("pressure", std::vector<std::string>(24, "1.0")).set_text("unit", "Pa");
  });

  EXPECT_ERROR(InputError, "not numeric in " + path_.string() + ":fields/pressure", read_el3d(path_));
}

}  // namespace
}  // namespace elrom::ingest
