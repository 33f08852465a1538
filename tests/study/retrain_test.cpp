#include "elrom/study/retrain.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/study/versions.hpp"
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

TEST_F(Retraining, ABetterBundleAnswersFromThenOn) {
  fit("nearest");
  grow();

  const auto report = retrain_with("linear");

  EXPECT_TRUE(report.promoted());
  ASSERT_TRUE(report.promotion.verdict);
  EXPECT_LT(report.promotion.verdict->mean.after, report.promotion.verdict->mean.before);
  EXPECT_EQ(method_of_model(), "linear");
  EXPECT_EQ(report.cases_before, 12u);
  EXPECT_EQ(report.cases_after, 16u);
  EXPECT_EQ(model::BundleReader(model()).info().cases.size(), 16u);
  EXPECT_EQ(report.promotion.verdict->judged_on, "held-out cases");
  EXPECT_EQ(report.promotion.number, 2);
  EXPECT_EQ(model::BundleReader(folder_ / "models/1.elrom").info().method, "nearest") << "kept";
}

TEST_F(Retraining, AWorseBundleIsKeptAndDoesNotAnswer) {
  fit("linear");
  const auto before = test::read_bytes(model());
  grow();

  const auto report = retrain_with("nearest");

  EXPECT_FALSE(report.promoted());
  EXPECT_GT(report.promotion.verdict->mean.after, report.promotion.verdict->mean.before);
  EXPECT_EQ(test::read_bytes(model()), before);
  EXPECT_EQ(model::BundleReader(folder_ / "models/2.elrom").info().method, "nearest");
  const Versions versions(folder_.path());
  EXPECT_EQ(versions.current(), 1);
  EXPECT_FALSE(versions.log().back().promoted);
  EXPECT_EQ(versions.log().back().by, "retrain");
}

TEST_F(Retraining, ARunDoesNotBringARefusedBundleIn) {
  fit("linear");
  const auto before = test::read_bytes(model());
  grow();
  (void)retrain_with("nearest");

  Study study(folder_.path(), settings("nearest"), {}, silent_log(), {});
  study.run();
  const auto first = study.promotion();
  study.run();

  EXPECT_EQ(first.kind, Promotion::Kind::refused);
  EXPECT_EQ(study.promotion().kind, Promotion::Kind::refused);
  EXPECT_EQ(study.promotion().number, first.number) << "the same bytes: no further version";
  EXPECT_EQ(test::read_bytes(model()), before);
}

TEST_F(Retraining, ARefusedRetrainingIsKnownWhenItIsRepeated) {
  fit("linear");
  grow();
  const auto first = retrain_with("nearest");
  const auto stages = test::read_bytes(folder_ / "timing.json");

  const auto again = retrain_with("nearest");

  EXPECT_FALSE(first.made_before);
  EXPECT_TRUE(again.made_before);
  EXPECT_FALSE(again.nothing_new);
  EXPECT_EQ(again.promotion.kind, Promotion::Kind::refused);
  EXPECT_EQ(again.promotion.number, first.promotion.number);
  EXPECT_EQ(to_json(*again.promotion.verdict), to_json(*first.promotion.verdict));
  EXPECT_EQ(Versions(folder_.path()).log().size(), 2u) << "the first model and one refusal";
  EXPECT_EQ(test::read_bytes(folder_ / "timing.json"), stages) << "nothing was trained";
}

TEST_F(Retraining, AnotherToleranceIsAskedOfTheGateAgain) {
  fit("linear");
  grow();
  const auto refused = retrain_with("nearest");
  ASSERT_FALSE(refused.promoted());
  auto tolerant = settings("nearest");
  tolerant.gate.tolerance = 100;

  const auto report = retrain(folder_.path(), tolerant, {}, silent_log(), {});

  EXPECT_TRUE(report.made_before);
  EXPECT_TRUE(report.promoted());
  EXPECT_EQ(Versions(folder_.path()).current(), refused.promotion.number);
}

TEST_F(Retraining, AModelThatLostFieldsIsRefused) {
  fit("linear");
  const auto fields = model::BundleReader(model()).info().fields;
  ASSERT_GT(fields.size(), 1u);
  auto fewer = settings("linear");
  fewer.fields = {fields.front().name};

  const auto report = retrain(folder_.path(), fewer, {}, silent_log(), {}, false);

  EXPECT_FALSE(report.promoted());
  ASSERT_TRUE(report.promotion.verdict);
  EXPECT_THAT(report.promotion.verdict->what_is_worse(), ::testing::Contains("no " + fields.back().name));
  EXPECT_EQ(model::BundleReader(model()).info().fields.size(), fields.size());
}

TEST_F(Retraining, AModelOfAnotherMeshIsRefused) {
  fit("linear");
  std::filesystem::remove(store_path());
  write_small_store(store_path(), 20, 0, small_furnace(), field::make_furnace_mesh({}, 2, 4, 4));
  test::RecordingLog log;

  const auto report = retrain(folder_.path(), settings("linear"), {}, log, {});

  EXPECT_FALSE(report.promoted());
  EXPECT_FALSE(report.promotion.verdict);
  EXPECT_THAT(log.text(), ::testing::HasSubstr("is the store that of this study?"));
  EXPECT_EQ(Versions(folder_.path()).current(), 1);
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

TEST_F(Retraining, WithoutNewCasesThereIsNothingToDo) {
  fit("linear");
  const auto before = test::read_bytes(model());

  const auto report = retrain_with("linear");

  EXPECT_TRUE(report.nothing_new);
  EXPECT_FALSE(report.promoted());
  EXPECT_EQ(test::read_bytes(model()), before);
  EXPECT_EQ(Versions(folder_.path()).log().size(), 1u);
  ASSERT_TRUE(report.promotion.verdict);
  EXPECT_EQ(report.promotion.verdict->mean.before, report.promotion.verdict->mean.after);
}

TEST_F(Retraining, OtherSettingsAreSomethingNew) {
  fit("linear");

  EXPECT_FALSE(retrain_with("nearest").nothing_new);
}

TEST_F(Retraining, TheNewBundleTellsWhereItComesFrom) {
  fit("linear");
  const auto parent = model::BundleReader(model()).digest();
  grow();
  auto dated = settings("linear");
  dated.date = "2026-11-24";

  (void)retrain(folder_.path(), dated, {}, silent_log(), {});

  const auto info = model::BundleReader(folder_ / "models/2.elrom").info();
  EXPECT_EQ(info.provenance.at("parent"), parent);
  EXPECT_EQ(info.provenance.at("date"), "2026-11-24");
  ASSERT_EQ(info.case_digests.size(), 16u);
  const auto store = field::SnapshotStore::open(store_path());
  const std::array<std::size_t, 1> first{store.find(info.cases.front()).front()};
  EXPECT_EQ(info.case_digests.front(), store.digest(first));
  EXPECT_THAT(info.settings, ::testing::HasSubstr("method = \"linear\""));
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
  RetrainReport report{
      .cases_before = 3, .cases_after = 5, .seconds = 2.5, .seconds_from_nothing = {}, .nothing_new = false};
  report.promotion.kind = Promotion::Kind::promoted;
  report.promotion.number = 7;
  report.promotion.verdict = GateVerdict();
  report.promotion.verdict->judged_on = "held-out cases";
  report.promotion.verdict->mean.before = 0.25;
  report.promotion.verdict->mean.after = 0.125;

  auto json = nlohmann::json::parse(to_json(report));

  EXPECT_EQ(io::check_json_kind(json, io::kinds::retrain, "report").minor, 1);
  EXPECT_EQ(json["verdict"]["before"], 0.25);
  json.erase("program");
  json.erase("verdict");
  EXPECT_EQ(json, nlohmann::json::parse(R"({"kind": "elrom-retrain", "format": [1, 1], "cases_before": 3,
      "cases_after": 5, "seconds": 2.5, "seconds_from_nothing": null, "error_before": 0.25, "error_after": 0.125,
      "judged_on": "held-out cases", "promoted": true, "nothing_new": false, "version": 7,
      "case_effects": null})"));
}

}  // namespace
}  // namespace elrom::study
