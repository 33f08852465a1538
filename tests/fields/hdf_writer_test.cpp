#include "hdf_writer.hpp"

#include <gmock/gmock.h>

#include "elrom/io/hdf5.hpp"
#include "support/sample_run.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::fields {
namespace {

using ::testing::ElementsAre;

TEST(HdfWriter, ScriptsFindPlanesTimesColumns) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  write_hdf(sample.run, sample.prediction(), folder / "a.hdf");

  const auto file = io::Hdf5File::open(folder / "a.hdf");

  const auto elrom = file.group("elrom");
  for (const io::Hdf5Object* object :
       {static_cast<const io::Hdf5Object*>(&file), static_cast<const io::Hdf5Object*>(&elrom)}) {
    EXPECT_EQ(object->text("case"), "case_a");
    EXPECT_EQ(object->text("bundle_digest"), std::string(64, 'b'));
    EXPECT_EQ(object->text("validity"), "inside");
  }
  EXPECT_EQ(file.text("kind"), "elrom-prediction");
  const auto pressure = file.dataset("elrom/fields/pressure");
  EXPECT_THAT(pressure.shape(), ElementsAre(3, 4));
  EXPECT_EQ(pressure.text("unit"), "Pa");
  EXPECT_EQ(pressure.read<float>()[5], 105);
  EXPECT_THAT(file.dataset("elrom/mesh/centre").shape(), ElementsAre(3, 4, 3));
  EXPECT_THAT(file.dataset("elrom/boundary_conditions").read<double>(), ElementsAre(1.5, 2.5));
  EXPECT_THAT(file.dataset("elrom/boundary_conditions").texts("names"), ElementsAre("air", "fuel"));
  EXPECT_EQ(file.group("elrom").number("load"), 0.64);
}

TEST(HdfWriter, ParaViewFindsOneValueACellInTheSameBytes) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  write_hdf(sample.run, sample.prediction(), folder / "a.hdf");

  const auto file = io::Hdf5File::open(folder / "a.hdf");

  EXPECT_EQ(file.group("VTKHDF").text("Type"), "UnstructuredGrid");
  EXPECT_THAT(file.dataset("VTKHDF/NumberOfCells").read<std::int64_t>(), ElementsAre(12));
  const auto flat = file.dataset("VTKHDF/CellData/pressure");
  EXPECT_THAT(flat.shape(), ElementsAre(12));
  EXPECT_EQ(flat.read<float>(), file.dataset("elrom/fields/pressure").read<float>());
  EXPECT_THAT(file.dataset("VTKHDF/Offsets").shape(), ElementsAre(13));
}

TEST(HdfWriter, TheFileMayBeRenamed) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  write_hdf(sample.run, sample.prediction(), folder / "a.tmp");

  std::filesystem::rename(folder / "a.tmp", folder / "b.hdf");

  EXPECT_EQ(io::Hdf5File::open(folder / "b.hdf").dataset("VTKHDF/CellData/pressure").read<float>()[7], 107);
}

TEST(HdfWriter, ARegionIsOneRowOfCellsWithTheirNumbers) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample({}, parse_box(":5.3,:,20:"));
  write_hdf(sample.run, sample.prediction(), folder / "a.hdf");

  const auto file = io::Hdf5File::open(folder / "a.hdf");

  EXPECT_THAT(file.dataset("elrom/mesh/cells").read<std::int32_t>(), ElementsAre(4, 6, 8, 10));
  EXPECT_THAT(file.dataset("elrom/fields/pressure").read<float>(), ElementsAre(104, 106, 108, 110));
  EXPECT_THAT(file.dataset("VTKHDF/CellData/pressure").read<float>(), ElementsAre(104, 106, 108, 110));
}

TEST(HdfWriter, SameContentGivesSameBytes) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;

  write_hdf(sample.run, sample.prediction(), folder / "a");
  write_hdf(sample.run, sample.prediction(), folder / "b");

  EXPECT_EQ(test::read_bytes(folder / "a"), test::read_bytes(folder / "b"));
}

TEST(HdfWriter, TheOrderInWhichFieldsBecomeReadyDoesNotChangeTheBytes) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  const auto prediction = sample.prediction();
  write_hdf(sample.run, prediction, folder / "a");

  HdfWriter writer(sample.run, *prediction.inputs, *prediction.assessment, folder / "b");
  writer.write_field(prediction, 1);
  writer.write_field(prediction, 0);
  writer.finish(prediction);

  EXPECT_EQ(test::read_bytes(folder / "a"), test::read_bytes(folder / "b"));
}

}  // namespace
}  // namespace elrom::fields
