#include "earlier_model.hpp"

#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <set>

#include "elrom/methods/peers.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/study/study.hpp"
#include "study_fixture.hpp"
#include "support/temporary_folder.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::study {
namespace {

using Names = std::set<std::string>;

/// A study of 15 cases, 3 of them held out; `grow` adds 3 more.
class EarlierModels : public ::testing::Test {
 protected:
  EarlierModels() { write_small_store(folder_ / "snapshots.h5", 15); }
  void grow() const { write_small_store(folder_ / "snapshots.h5", 3, 15); }
  [[nodiscard]] Settings settings() const {
    return read_settings(folder_ / "study.toml", {"effort=quick", "peers.networks=false", "threads=1"});
  }
  void fit() const { Study(folder_.path(), settings(), {}, silent_log(), {}).fit(); }
  /// Of a bundle in the folder.
  [[nodiscard]] nlohmann::json accuracy(const std::string& bundle = "model.elrom") const {
    return nlohmann::json::parse(model::BundleReader(folder_ / bundle).info().accuracy_json);
  }
  /// "again.elrom", begun at model.elrom whether or not it is better.
  void fit_again(int threads = 1) const {
    auto own = settings();
    own.threads = threads;
    Study study(folder_.path(), own, {}, silent_log(), {});
    study.begin_at(folder_ / "model.elrom");
    study.fit(folder_ / "again.elrom");
  }
  [[nodiscard]] Names kept_results() const {
    Names names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "stages"))
      names.insert(entry.path().filename().string());
    return names;
  }

  test::TemporaryFolder folder_;
};

TEST_F(EarlierModels, CandidatesWithoutAPartStayOutUntilTheCasesHaveGrownByAQuarter) {
  fit();
  const EarlierModel earlier(folder_ / "model.elrom");
  std::vector<std::unique_ptr<methods::Method>> peers;
  std::vector<const methods::Method*> candidates;
  Names without_part;
  const auto own = accuracy()["pressure"]["candidates"];
  for (const auto& one : own) {
    if (one["name"] == "kernel") continue;
    peers.push_back(methods::make_peer(one["name"].get<std::string>()));
    candidates.push_back(peers.back().get());
    if (one["weight"] == 0.0) without_part.insert(one["name"]);
  }
  ASSERT_FALSE(without_part.empty());

  const auto out = earlier.left_out("pressure", candidates, 15);

  Names named;
  for (const auto& one : out) {
    named.insert(one.name);
    EXPECT_EQ(one.n_cases, 12u);
  }
  EXPECT_EQ(named, without_part);
  EXPECT_TRUE(earlier.left_out("pressure", candidates, 16).empty());
  EXPECT_TRUE(earlier.left_out("no such field", candidates, 14).empty());
}

TEST_F(EarlierModels, ARetrainedBundleTellsOfThoseLeftOutAndWhenTheyWereFitted) {
  fit();
  grow();

  fit_again();

  int told = 0;
  const auto again = accuracy("again.elrom");
  for (const auto& candidate : again["pressure"]["candidates"]) {
    if (!candidate.contains("cases")) continue;
    ++told;
    EXPECT_EQ(candidate["cases"], 12);
    EXPECT_EQ(candidate["weight"], 0.0);
  }
  EXPECT_GT(told, 0);
}

TEST_F(EarlierModels, ResultsThatBeganAtAnotherModelAreNotTaken) {
  fit();
  const auto cold = kept_results();

  fit_again();  // the same cases: all that differs is where it began

  EXPECT_GT(kept_results().size(), cold.size());
  const auto warm = kept_results();
  fit();
  EXPECT_EQ(kept_results(), warm) << "and a fit from nothing takes its own";
}

TEST_F(EarlierModels, BeginningTwiceAtTheSameModelGivesTheSameBytesForAnyThreads) {
  fit();
  const auto first = test::read_bytes(folder_ / "model.elrom");
  grow();
  const auto bytes_with = [&](int threads) {
    std::filesystem::remove_all(folder_ / "stages");
    fit_again(threads);
    return test::read_bytes(folder_ / "again.elrom");
  };

  const auto one = bytes_with(1);

  EXPECT_EQ(bytes_with(3), one);
  EXPECT_NE(one, first);
}

/// Of a model of four cases: networks had a part in the contest for pressure alone.
class KnownRows : public ::testing::Test {
 protected:
  KnownRows() { write("{}"); }
  void write(const std::string& more) const {
    const auto cases = study_cases_of_four();
    model::Bundle bundle;
    bundle.info = {.method = "auto",
                   .fields = {},
                   .schema = cases.schema,
                   .cases = {"a", "b", "c", "d"},
                   .case_digests = {"1", "2", "3", "4"},
                   .provenance = {{"settings", "s"}},
                   .settings = {}};
    auto accuracy = nlohmann::json::parse(R"({"pressure": {"candidates": [{"name": "networks"}]},
        "density": {"candidates": [{"name": "networks", "cases": 3}]},
        "velocity": {"candidates": [{"name": "kernel"}]}})");
    accuracy["pressure"].update(nlohmann::json::parse(more));
    bundle.info.accuracy_json = accuracy.dump();
    bundle.mesh = cases.mesh;
    bundle.guard = model::Guard(cases.schema, cases.inputs, bundle.info.cases, cases.loads);
    bundle.write(folder_ / "model.elrom");
  }
  [[nodiscard]] static field::CaseSet study_cases_of_four() { return test::toy_cases(4); }
  [[nodiscard]] std::vector<std::size_t> rows(const PresentStudy& now,
                                              const std::string& field = "pressure") const {
    return EarlierModel(folder_ / "model.elrom").known_rows(field, now);
  }
  const PresentStudy now_{.cases = {"a", "new", "b", "c", "d"},
                          .case_digests = {"1", "9", "2", "3", "4"},
                          .settings_digest = "s"};
  test::TemporaryFolder folder_;
};

TEST_F(KnownRows, AreThoseOfTheEarlierCasesWhereNetworksTookPart) {
  EXPECT_EQ(rows(now_), (std::vector<std::size_t>{0, 2, 3, 4}));
  EXPECT_TRUE(rows(now_, "density").empty()) << "they were left out last time";
  EXPECT_TRUE(rows(now_, "velocity").empty());
  EXPECT_TRUE(rows(now_, "no such field").empty());
}

TEST_F(KnownRows, AreNoneOnceACaseHasLeftOrChangedOrSettingsHave) {
  auto left = now_, changed = now_, other = now_;
  left.cases[4] = "another";
  changed.case_digests[4] = "5";
  other.settings_digest = "t";

  EXPECT_TRUE(rows(left).empty());
  EXPECT_TRUE(rows(changed).empty());
  EXPECT_TRUE(rows(other).empty());
}

TEST_F(KnownRows, AreNoneOnceTheCasesHaveGrownByMoreThanAQuarter) {
  auto more = now_;
  more.cases.push_back("newer");
  more.case_digests.push_back("8");

  EXPECT_TRUE(rows(more).empty());
}

TEST_F(KnownRows, AreStillThoseOfTheLastTrainingFromNothingAfterARetraining) {
  write(R"({"known": ["a", "b", "c"]})");
  EXPECT_TRUE(rows(now_).empty()) << "five are more than a quarter more than three";
  write(R"({"known": ["d", "a", "b", "c"]})");
  EXPECT_EQ(rows(now_), (std::vector<std::size_t>{0, 2, 3, 4}));
}

}  // namespace
}  // namespace elrom::study
