#include "elrom/masters/build_work.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/study/versions.hpp"
#include "simulated_case.hpp"
#include "study/study_fixture.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::masters {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;

const std::string digest(64, 'b');

/// A study of 15 cases, 3 of them held out, and a simulation of another operating point.
struct Learner {
  test::TemporaryFolder folder;
  BuildOptions options;
  serve::Claimed claimed;

  Learner() {
    folder.write("study/study.toml",
                 "effort = \"quick\"\nmethod = \"linear\"\n[peers]\nnetworks = false\nmethods = []\n");
    study::write_small_store(folder / "study/snapshots.h5", 15);
    options = {.study = folder / "study", .enough = 1, .folder = folder.path()};
    (void)study::Study(options.study, study::study_settings(options.study), {}, silent_log(), {}).fit();
    claimed = {.run = 9, .inputs_digest = digest};
    claimed.sources = {{.id = 1, .model = "elrom"}, {.id = 2, .model = "el3d", .fields = simulation(1)}};
  }
  /// The case that comes after those of the study. @param factor of its pressure
  [[nodiscard]] std::string simulation(float factor,
                                       const std::string& name = case_name("el3d", digest)) const {
    const auto next = folder / "next.h5", renamed = folder / "renamed.h5", file = folder / "sent.hdf";
    for (const auto& old : {next, renamed}) std::filesystem::remove(old);
    study::write_small_store(next, 1, 15);
    const auto store = field::SnapshotStore::open(next);
    const std::size_t only = 0;
    field::Snapshot snapshot{.record = store.cases()[0], .fields = {}};
    snapshot.record.inputs.name = name;
    snapshot.fields.resize(2, static_cast<Eigen::Index>(store.mesh().n_cells()));
    snapshot.fields.row(0) = factor * store.read("pressure", std::span(&only, 1)).row(0);
    snapshot.fields.row(1) = store.read("gas_velocity_z", std::span(&only, 1)).row(0);
    field::SnapshotWriter writer(renamed, store.mesh(), store.schema(), store.fields());
    writer.add(snapshot);
    writer.commit();
    write_simulation(field::SnapshotStore::open(renamed), "a solver", file);
    return test::read_bytes(file);
  }
  serve::Finished work() const { return build_work(options, silent_log())(claimed, {}); }
  [[nodiscard]] std::size_t n_cases() const {
    return field::SnapshotStore::open(folder / "study/snapshots.h5").n_cases();
  }
};

TEST(BuildWork, ACaseIsTakenInAndLearned) {
  const Learner learner;

  const auto finished = learner.work();

  EXPECT_EQ(learner.n_cases(), 16U);
  EXPECT_THAT(finished.reason, HasSubstr("12 -> 13 cases: version 2"));
  const auto report = Json::parse(finished.document)["training"];
  EXPECT_EQ(report["cases_after"], 13);
  EXPECT_TRUE(report["verdict"]["passed"].is_boolean());
  const auto cases = model::BundleReader(learner.options.study / "models/2.elrom").info().cases;
  EXPECT_THAT(cases, ::testing::Contains("el3d_bbbbbbbbbbbb"));
}

TEST(BuildWork, TooFewNewCasesWaitForMore) {
  Learner learner;
  learner.options.enough = 2;

  const auto finished = learner.work();

  EXPECT_EQ(learner.n_cases(), 16U);
  EXPECT_EQ(finished.reason, "1 of 2 new cases; not trained");
  EXPECT_EQ(study::Versions(learner.options.study).current(), 1);
}

TEST(BuildWork, ACaseThatCameBeforeIsNotTakenTwice) {
  Learner learner;
  learner.options.enough = 2;

  (void)learner.work();
  const auto again = learner.work();

  EXPECT_EQ(learner.n_cases(), 16U);
  EXPECT_EQ(again.reason, "1 of 2 new cases; not trained");
}

TEST(BuildWork, WhatTheChecksRefuseIsPutAsideAndLearnedByNobody) {
  Learner learner;
  learner.claimed.sources[1].fields = learner.simulation(0.001F);

  EXPECT_ERROR(serve::WrongResultError, "pressure", learner.work());

  EXPECT_EQ(learner.n_cases(), 15U);
}

TEST(BuildWork, FieldsOfAnotherCaseAndPredictionsAreRefused) {
  Learner learner;
  learner.claimed.sources[1].fields = learner.simulation(1, "another");
  EXPECT_ERROR(serve::WrongResultError, "fields of another case: found 'another'", learner.work());

  learner.claimed.sources[1].fields = "no HDF5";
  EXPECT_THROW(learner.work(), serve::WrongResultError);
  EXPECT_EQ(learner.n_cases(), 15U);
}

}  // namespace
}  // namespace elrom::masters
