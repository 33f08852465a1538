#include "elrom/study/retrain.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/predictor.hpp"
#include "study_fixture.hpp"
#include "support/recording_log.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::study {
namespace {

/// A study of 15 cases, 3 of them held out; `grow` adds 5 more, one of them held out.
class Retraining : public ::testing::Test {
 protected:
  Retraining() { write_small_store(store_path(), 15); }
  void grow() const { write_small_store(store_path(), 5, 15); }

  [[nodiscard]] Settings settings(const std::string& method, bool hold_out = true) const {
    std::vector<std::string> lines{"effort=quick", "method=" + method, "peers.networks=false"};
    if (!hold_out) lines.emplace_back("split.held_out=[]");
    return read_settings(folder_.path() / "study.toml", lines);
  }
  void fit(const std::string& method, bool hold_out = true) const {
    Study(folder_.path(), settings(method, hold_out), {}, silent_log(), {}).fit();
  }
  [[nodiscard]] RetrainReport retrain_with(const std::string& method, bool hold_out = true,
                                           bool compare = false) const {
    return retrain(folder_.path(), settings(method, hold_out), {}, silent_log(), {}, compare);
  }
  [[nodiscard]] std::filesystem::path store_path() const { return folder_.path() / "snapshots.h5"; }
  [[nodiscard]] std::filesystem::path model() const { return folder_.path() / "model.elrom"; }
  [[nodiscard]] std::string method_of_model() const { return model::BundleReader(model()).info().method; }

  test::TemporaryFolder folder_;
};

TEST_F(Retraining, ABetterBundleReplacesTheModel) {
  fit("nearest");
  grow();

  const auto report = retrain_with("linear");

  EXPECT_TRUE(report.promoted);
  EXPECT_LT(report.error_after, report.error_before);
  EXPECT_EQ(method_of_model(), "linear");
  EXPECT_EQ(report.cases_before, 12u);
  EXPECT_EQ(report.cases_after, 16u);
  EXPECT_EQ(model::BundleReader(model()).info().cases.size(), 16u);
  EXPECT_TRUE(report.on_held_out_cases);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "candidate.elrom"));
}

TEST_F(Retraining, AWorseBundleIsThrownAway) {
  fit("linear");
  const auto before = test::read_bytes(model());
  grow();

  const auto report = retrain_with("nearest");

  EXPECT_FALSE(report.promoted);
  EXPECT_GT(report.error_after, report.error_before);
  EXPECT_EQ(test::read_bytes(model()), before);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "candidate.elrom"));
}

TEST_F(Retraining, JudgingCasesThatWereTrainedOnIsTold) {
  test::RecordingLog log;
  fit("linear", false);

  (void)retrain(folder_.path(), settings("linear"), {}, log, {});

  EXPECT_THAT(log.text(), ::testing::HasSubstr("the present model was trained on"));
}

TEST_F(Retraining, TrainingOnCasesThatWereHeldOutIsTold) {
  test::RecordingLog log;
  fit("linear");

  (void)retrain(folder_.path(), settings("linear", false), {}, log, {});

  EXPECT_THAT(log.text(), ::testing::HasSubstr("2 more cases were held out so far and are trained on now"));
}

TEST_F(Retraining, ABundleThatIsAsGoodIsTaken) {
  fit("linear");

  const auto report = retrain_with("linear");

  EXPECT_EQ(report.error_after, report.error_before);
  EXPECT_TRUE(report.promoted);
}

TEST_F(Retraining, HeldOutErrorIsTheNrmseOverHeldOutCasesAgainstTheMeanOfTheOthers) {
  fit("linear");
  const auto store = field::SnapshotStore::open(store_path());
  const auto rows = store.find("load_*"), others = store.find("train_*");
  const model::Predictor predictor(model());
  const auto inputs = store.inputs(rows);
  const auto n_cells = static_cast<Eigen::Index>(store.mesh().n_cells());
  double expected = 0;
  for (std::size_t f = 0; f < predictor.fields().size(); ++f) {
    const MatrixD truth = store.read(predictor.fields()[f].name, rows).cast<double>();
    const Eigen::RowVectorXd mean =
        store.read(predictor.fields()[f].name, others).cast<double>().colwise().mean();
    MatrixD predicted(truth.rows(), truth.cols());
    for (Eigen::Index i = 0; i < truth.rows(); ++i) {
      std::vector<float> values(predictor.size());
      model::Predictor::Scratch scratch;
      predictor.predict({inputs.row(i).data(), 3}, values, {}, scratch);
      for (Eigen::Index c = 0; c < n_cells; ++c)
        predicted(i, c) = values[f * static_cast<std::size_t>(n_cells) + static_cast<std::size_t>(c)];
    }
    expected += (predicted - truth).norm() / (truth.rowwise() - mean).norm() / 2;  // of two fields
  }

  EXPECT_NEAR(held_out_error(model(), store, rows), expected, 1e-6 * expected);
  EXPECT_GT(expected, 0);
  EXPECT_LT(expected, 1);
}

TEST_F(Retraining, WithoutHeldOutCasesTheBundlesCrossValidationJudges) {
  fit("nearest", false);
  const auto accuracy = nlohmann::json::parse(model::BundleReader(model()).info().accuracy_json);
  const double expected =
      (accuracy["pressure"]["nrmse"].get<double>() + accuracy["gas_velocity_z"]["nrmse"].get<double>()) / 2;

  const auto report = retrain_with("linear", false);

  EXPECT_FALSE(report.on_held_out_cases);
  EXPECT_DOUBLE_EQ(report.error_before, expected);
  EXPECT_TRUE(report.promoted);
  EXPECT_EQ(method_of_model(), "linear");
}

TEST_F(Retraining, AStudyWithoutAModelHasNothingToRetrain) {
  EXPECT_ERROR(InputError, "use elrom-train run first", retrain_with("linear"));
}

TEST_F(Retraining, ComparingBuildsFromNothingBesideAndLeavesNothingThere) {
  fit("linear");

  base::write_text(folder_ / "timing.json", R"({"kind": "elrom-timing", "format": [1, 4],
    "from_nothing": {"total_seconds": 1e6, "stages": {}}})");

  const auto report = retrain_with("linear", true, true);

  ASSERT_TRUE(report.seconds_from_nothing);
  EXPECT_GT(*report.seconds_from_nothing, 0);
  EXPECT_LT(*report.seconds_from_nothing, 1e6) << "measured, and not the recorded time";
  EXPECT_FALSE(std::filesystem::exists(folder_ / ".from_nothing"));
}

TEST_F(Retraining, TheRecordedTimeOfAFullRunIsReported) {
  fit("linear");
  const std::string rest = R"("from_nothing": {"total_seconds": 12.5, "stages": {}}})";
  base::write_text(folder_ / "timing.json", R"({"kind": "elrom-timing", "format": [1, 4], )" + rest);
  EXPECT_EQ(retrain_with("linear").seconds_from_nothing, 12.5);

  base::write_text(folder_ / "timing.json", R"({"kind": "elrom-timing", "format": [2, 0], )" + rest);
  EXPECT_FALSE(retrain_with("linear").seconds_from_nothing)
      << "of another version: not known, and no reason to stop";
}

TEST(RetrainReport, IsWrittenAsDocumented) {
  const RetrainReport report{.cases_before = 3,
                             .cases_after = 5,
                             .seconds = 2.5,
                             .seconds_from_nothing = {},
                             .error_before = 0.25,
                             .error_after = 0.125,
                             .on_held_out_cases = true,
                             .promoted = true};

  auto json = nlohmann::json::parse(to_json(report));

  EXPECT_EQ(io::check_json_kind(json, io::kinds::retrain, "report").minor, 0);
  json.erase("program");
  EXPECT_EQ(json, nlohmann::json::parse(R"({"kind": "elrom-retrain", "format": [1, 0], "cases_before": 3,
      "cases_after": 5, "seconds": 2.5, "seconds_from_nothing": null, "error_before": 0.25, "error_after": 0.125,
      "judged_on": "held-out cases", "promoted": true})"));
}

}  // namespace
}  // namespace elrom::study
