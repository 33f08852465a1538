#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "elrom/ingest/store_summary.hpp"
#include "elrom/io/hdf5.hpp"
#include "elrom/model/prediction_file.hpp"
#include "support/sample_run.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::ingest {
namespace {

using ::testing::HasSubstr;

TEST(PredictionSummary, TellsCaseValidityModelInputsAndRanges) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  model::write_prediction(sample.frame, sample.prediction(), folder / "a.hdf");

  const auto description = describe_prediction(folder / "a.hdf");

  EXPECT_EQ(description["case"], "case_a");
  EXPECT_EQ(description["validity_reason"], "as good as trained");
  EXPECT_EQ(description["n_planes"], 3);
  EXPECT_EQ(description["inputs"][1]["value"], 2.5);
  const auto& pressure = description["fields"][1];
  EXPECT_EQ(pressure["name"], "pressure");
  EXPECT_EQ(pressure["min"], 100);
  EXPECT_EQ(pressure["max"], 111);
  const auto words = in_words(description);
  EXPECT_THAT(words, HasSubstr("prediction of case case_a: load 64.0 %, 3 planes"));
  EXPECT_THAT(words, HasSubstr("model of method 'networks', mean of the builds"));
}

TEST(PredictionSummary, RefusesAnotherKindOfFile) {
  EXPECT_ERROR(InputError, "found elrom-mesh, expected elrom-prediction",
               describe_prediction(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.h5"));
}

TEST(PredictionSummary, TakesANewerMinorVersionAndRefusesANewerMajorOne) {
  const test::TemporaryFolder folder;
  const test::SampleRun sample;
  model::write_prediction(sample.frame, sample.prediction(), folder / "a.hdf");
  const auto mark = [&](int major, int minor) {
    auto file = io::Hdf5File::open(folder / "a.hdf", io::Hdf5File::Access::edit);
    file.set_integers("format", std::vector<std::int64_t>{major, minor});
    file.close();
  };

  mark(1, 9);
  EXPECT_NO_THROW(static_cast<void>(describe_prediction(folder / "a.hdf")));
  mark(2, 0);
  EXPECT_ERROR(InputError, "found elrom-prediction 2.0", describe_prediction(folder / "a.hdf"));
}

}  // namespace
}  // namespace elrom::ingest
