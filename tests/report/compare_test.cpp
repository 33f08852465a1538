#include "elrom/report/compare.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "report/small_study.hpp"
#include "support/throws.hpp"

namespace elrom::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

// The study's model is the nearest case; beside it lies a linear one, which is better, and one that has seen
// some of the held-out cases.
class Compare : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    study_ = std::make_unique<SmallStudy>(
        std::filesystem::path(::testing::TempDir()) / ("elrom-compare-" + std::to_string(::getpid())),
        SmallStudy::Options{.main_method = "nearest", .n_held_out = 6});
    study_->train("linear", {"train_*", "load_12", "load_13"}, file("knows.elrom"));
  }
  static void TearDownTestSuite() { study_.reset(); }
  static std::filesystem::path file(const std::string& name) { return study_->folder() / name; }
  static std::filesystem::path linear() { return file("peers") / "linear.elrom"; }
  static Comparison run(const std::filesystem::path& a, const std::filesystem::path& b,
                        const std::vector<std::string>& cases = {}, bool figures = false) {
    return compare({.a = a, .b = b, .cases = cases, .figures = figures}, silent_log());
  }
  static std::unique_ptr<SmallStudy> study_;
};
std::unique_ptr<SmallStudy> Compare::study_;

TEST_F(Compare, ABetterModelIsCalledBetterAndAWorseOneWorse) {
  const auto better = run(study_->folder(), linear()), worse = run(linear(), study_->folder());

  EXPECT_EQ(better.report.cases.size(), 6U);
  EXPECT_EQ(better.mean.gain.verdict(), Gain::Verdict::better);
  EXPECT_FALSE(better.b_is_worse());
  EXPECT_THAT(headline(better), HasSubstr("B is better than A on 6 runs: mean NRMSE "));
  EXPECT_EQ(worse.mean.gain.verdict(), Gain::Verdict::worse);
  EXPECT_TRUE(worse.b_is_worse());
  EXPECT_DOUBLE_EQ(worse.mean.a, better.mean.b);
  for (const auto& field : better.fields)
    EXPECT_NEAR(field.gain.value, 1 - field.b / field.a, 1e-12) << field.field;
}

TEST_F(Compare, AModelIsNoDifferentFromItself) {
  const auto same = run(linear(), linear());

  EXPECT_EQ(same.mean.gain.value, 0);
  EXPECT_FALSE(same.b_is_worse());
  EXPECT_THAT(headline(same), HasSubstr("No difference shown between A and B"));
  for (const auto& field : same.fields) EXPECT_EQ(verdict_text(field.gain), "no difference shown");
}

TEST_F(Compare, ScoresAreThoseOfTheAccuracyReport) {
  const auto report = evaluate({.study = study_->folder()}, silent_log());
  const auto comparison = run(study_->folder(), linear());

  for (std::size_t f = 0; f < report.fields.size(); ++f) {
    EXPECT_DOUBLE_EQ(comparison.fields[f].a, report.fields[f].nrmse(0));
    EXPECT_DOUBLE_EQ(comparison.fields[f].b, report.fields[f].nrmse(2));
  }
  EXPECT_DOUBLE_EQ(comparison.mean.b, report.methods[2].mean_nrmse);
}

TEST_F(Compare, CasesThatOneHasSeenAreNoTest) {
  const auto comparison = run(study_->folder(), file("knows.elrom"));

  EXPECT_THAT(comparison.left_out, ElementsAre("load_12", "load_13"));
}

TEST_F(Compare, ASeenCaseByNameIsRefused) {
  EXPECT_ERROR(UsageError, "B was trained on case 'load_12'",
               run(study_->folder(), file("knows.elrom"), {"load_12", "load_14"}));
  EXPECT_ERROR(InputError, "no case is left", run(study_->folder(), linear(), {"train_*"}));
  EXPECT_ERROR(UsageError, "holds no case 'lood_12'", run(study_->folder(), linear(), {"lood_12"}));
}

TEST_F(Compare, NamedCasesAloneAreJudged) {
  const auto comparison = run(study_->folder(), linear(), {"load_14", "load_16"});

  ASSERT_EQ(comparison.report.cases.size(), 2U);
  EXPECT_EQ(comparison.report.cases[1].name, "load_16");
  EXPECT_THAT(headline(comparison), HasSubstr("too few cases for an interval"));
}

TEST_F(Compare, BundlesThatLieInNoStudyNeedStoreAndCases) {
  const auto alone =
      std::filesystem::path(::testing::TempDir()) / ("alone-" + std::to_string(::getpid()) + ".elrom");
  std::filesystem::copy_file(linear(), alone);

  EXPECT_ERROR(UsageError, "name a study, or --store and --cases", run(alone, linear()));
  const auto comparison = compare(
      {.a = alone, .b = study_->folder(), .cases = {"load_*"}, .store = file("snapshots.h5")}, silent_log());

  EXPECT_TRUE(comparison.b_is_worse());
  std::filesystem::remove(alone);
}

TEST_F(Compare, TableJsonAndPageTellTheSame) {
  const auto comparison = run(study_->folder(), linear(), {}, true);
  const auto root = nlohmann::json::parse(to_json(comparison));
  const auto page = html_page(comparison);

  EXPECT_EQ(root["kind"], "elrom-comparison");
  EXPECT_EQ(root["headline"], headline(comparison));
  EXPECT_EQ(root["mean"]["verdict"], "better");
  EXPECT_EQ(root["fields"].size(), 3U);
  EXPECT_EQ(root["cases"].size(), 6U);
  EXPECT_THAT(terminal_table(comparison), HasSubstr(headline(comparison)));
  EXPECT_THAT(page, HasSubstr("B is better than A"));
  // Truth, A, B, and their three differences.
  for (const auto* series : {"\"0\"", "\"1\"", "\"2\"", "\"1-0\"", "\"2-0\"", "\"2-1\""})
    EXPECT_THAT(page, HasSubstr(std::string("<canvas data-series=") + series));
  for (const auto* fetches : {"http://", "https://", "src=", "@import", "<link"})
    EXPECT_THAT(page, Not(HasSubstr(fetches)));
}

}  // namespace
}  // namespace elrom::report
