#include "elrom/model/prediction_file.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "elrom/io/hdf5.hpp"
#include "support/sample_bundle.hpp"
#include "support/sample_run.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::model {
namespace {

using ::testing::ElementsAre;

TEST(PredictionFile, ScriptsFindPlanesTimesColumns) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  write_prediction(sample.frame, sample.prediction(), folder / "a.hdf");

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

TEST(PredictionFile, ParaViewFindsOneValueACellInTheSameBytes) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  write_prediction(sample.frame, sample.prediction(), folder / "a.hdf");

  const auto file = io::Hdf5File::open(folder / "a.hdf");

  EXPECT_EQ(file.group("VTKHDF").text("Type"), "UnstructuredGrid");
  EXPECT_THAT(file.dataset("VTKHDF/NumberOfCells").read<std::int64_t>(), ElementsAre(12));
  const auto flat = file.dataset("VTKHDF/CellData/pressure");
  EXPECT_THAT(flat.shape(), ElementsAre(12));
  EXPECT_EQ(flat.read<float>(), file.dataset("elrom/fields/pressure").read<float>());
  EXPECT_THAT(file.dataset("VTKHDF/Offsets").shape(), ElementsAre(13));
}

TEST(PredictionFile, TheFileMayBeRenamed) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  write_prediction(sample.frame, sample.prediction(), folder / "a.tmp");

  std::filesystem::rename(folder / "a.tmp", folder / "b.hdf");

  EXPECT_EQ(io::Hdf5File::open(folder / "b.hdf").dataset("VTKHDF/CellData/pressure").read<float>()[7], 107);
}

TEST(PredictionFile, ARegionIsOneRowOfCellsWithTheirNumbers) {
  const test::TemporaryFolder folder;
  Box box;
  box.high[0] = 5.3;
  box.low[2] = 20;
  const test::SampleRun sample({.box = box});
  write_prediction(sample.frame, sample.prediction(), folder / "a.hdf");

  const auto file = io::Hdf5File::open(folder / "a.hdf");

  EXPECT_THAT(file.dataset("elrom/mesh/cells").read<std::int32_t>(), ElementsAre(4, 6, 8, 10));
  EXPECT_THAT(file.dataset("elrom/fields/pressure").read<float>(), ElementsAre(104, 106, 108, 110));
  EXPECT_THAT(file.dataset("VTKHDF/CellData/pressure").read<float>(), ElementsAre(104, 106, 108, 110));
}

TEST(PredictionFile, SameContentGivesSameBytes) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;

  write_prediction(sample.frame, sample.prediction(), folder / "a");
  write_prediction(sample.frame, sample.prediction(), folder / "b");

  EXPECT_EQ(test::read_bytes(folder / "a"), test::read_bytes(folder / "b"));
}

TEST(PredictionFile, TheOrderInWhichFieldsBecomeReadyDoesNotChangeTheBytes) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  const auto prediction = sample.prediction();
  write_prediction(sample.frame, prediction, folder / "a");

  PredictionWriter writer(sample.frame, *prediction.inputs, *prediction.assessment, folder / "b");
  writer.write_field(prediction, 1);
  writer.write_field(prediction, 0);
  writer.finish(prediction);

  EXPECT_EQ(test::read_bytes(folder / "a"), test::read_bytes(folder / "b"));
}

TEST(PredictionFile, WhatAPredictorWritesIsReadBack) {
  const test::TemporaryFolder folder;
  test::sample_bundle().write(folder / "model.elrom");
  BundleReader bundle(folder / "model.elrom");
  Extent extent(bundle, {.planes = {1, 3}});
  const Predictor predictor(folder / "model.elrom",
                            {.fields = {"pressure"}, .planes = {1, 3}, .interval_level = 0.8});
  const PredictionFrame frame(predictor, std::move(extent));
  const field::CaseInputs inputs{"case_b", 0.7, test::sample_case()};
  const auto assessment = predictor.guard().assess(inputs.values);
  std::vector<float> values(predictor.size()), half_width(predictor.size());
  Predictor::Scratch scratch;
  predictor.predict(inputs.values, values, half_width, scratch);

  write_prediction(frame,
                   {.inputs = &inputs, .assessment = &assessment, .values = values, .half_width = half_width},
                   folder / "b.hdf");
  const auto stored = read_prediction(folder / "b.hdf");

  EXPECT_EQ(stored.case_name, "case_b");
  EXPECT_EQ(stored.load, 0.7);
  EXPECT_EQ(stored.interval_level, 0.8);
  EXPECT_EQ(stored.bundle_digest, bundle.digest());
  EXPECT_EQ(stored.mesh_digest, bundle.mesh_digest());
  EXPECT_EQ(stored.validity_reason, assessment.reason);
  EXPECT_EQ(stored.builds, "mean");
  EXPECT_EQ(stored.inputs, inputs.values);
  EXPECT_EQ(stored.input_names, bundle.info().schema.names());
  EXPECT_THAT(stored.planes, ElementsAre(1, 3));
  EXPECT_FALSE(stored.profiles);
  EXPECT_EQ(stored.centre.size(), 2U * 12 * 3);
  const auto& pressure = stored.field("pressure");
  EXPECT_EQ(pressure.unit, "Pa");
  EXPECT_THAT(pressure.shape, ElementsAre(2, 12));
  EXPECT_EQ(pressure.values, values);
  EXPECT_EQ(pressure.half_width, half_width);
  EXPECT_ERROR(UsageError, "did you mean 'pressure'", (void)stored.field("presure"));
}

TEST(PredictionFile, ProfilesAndRegionsAreReadAsWhatTheyAre) {
  const test::TemporaryFolder folder;
  test::SampleRun profile({.profile = true});
  profile.values = {1, 2, 3, 4, 5, 6};
  write_prediction(profile.frame, profile.prediction(), folder / "profile.hdf");
  const test::SampleRun region({.planes = {1}, .box = Box{{-100, -100, -100}, {5.3, 100, 100}}});
  write_prediction(region.frame, region.prediction(), folder / "region.hdf");

  const auto read = read_prediction(folder / "profile.hdf");
  EXPECT_TRUE(read.profiles);
  EXPECT_EQ(read.heights.size(), 3U);
  EXPECT_THAT(read.field("pressure").values, ElementsAre(1, 2, 3));
  EXPECT_THAT(read_prediction(folder / "region.hdf").cells, ElementsAre(4, 6));
}

TEST(PredictionFile, OtherFilesAreRefused) {
  EXPECT_ERROR(InputError, "found elrom-mesh, expected elrom-prediction",
               (void)read_prediction(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.h5"));
}

}  // namespace
}  // namespace elrom::model
