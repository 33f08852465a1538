#include "elrom/report/accuracy.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/report/cost.hpp"
#include "elrom/report/learning_curve.hpp"
#include "elrom/report/page.hpp"
#include "report/small_study.hpp"
#include "support/recording_log.hpp"
#include "support/throws.hpp"

namespace elrom::report {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

std::filesystem::path folder(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) /
         ("elrom-report-" + name + "-" + std::to_string(::getpid()));
}

// One study for all tests of this file: it takes most of their time.
class Accuracy : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    study_ = std::make_unique<SmallStudy>(folder("accuracy"));
    report_ = std::make_unique<AccuracyReport>(
        evaluate({.study = study_->folder(), .figures = true}, silent_log()));
  }
  static void TearDownTestSuite() {
    report_.reset();
    study_.reset();
  }
  static std::unique_ptr<SmallStudy> study_;
  static std::unique_ptr<AccuracyReport> report_;
};
std::unique_ptr<SmallStudy> Accuracy::study_;
std::unique_ptr<AccuracyReport> Accuracy::report_;

TEST_F(Accuracy, ScoresHeldOutLoadsAndKeepsRepeatsForTheNoise) {
  ASSERT_EQ(report_->cases.size(), 2u);
  EXPECT_EQ(report_->cases[0].name, "load_12");
  EXPECT_THAT(report_->repeats, ::testing::UnorderedElementsAre("load_12", "rep1", "rep2"));
  EXPECT_EQ(report_->n_training, SmallStudy::n_training);
}

TEST_F(Accuracy, TheSameModelScoresTheSameAsItsPeer) {
  // model.elrom is the linear peer under another name.
  ASSERT_EQ(report_->methods[2].file.name, "linear");
  for (const auto& field : report_->fields) EXPECT_DOUBLE_EQ(field.nrmse(0), field.nrmse(2));
  EXPECT_DOUBLE_EQ(report_->gain().value, 0.0);
  EXPECT_EQ(report_->fields_won(), report_->fields.size());
}

TEST_F(Accuracy, PooledScoreFollowsFromTheStoreByHand) {
  const auto store = field::SnapshotStore::open(study_->folder() / "snapshots.h5");
  const auto truth = store.read("pressure", store.find("load_*")),
             training = store.read("pressure", store.find("train_*"));
  const MatrixD mean = training.cast<double>().colwise().mean();
  const model::Predictor predictor(study_->folder() / "model.elrom", {.fields = {"pressure"}});
  model::Predictor::Scratch scratch;
  std::vector<float> values(predictor.size());
  double error = 0, departure = 0;
  const auto inputs = store.inputs(store.find("load_*"));
  for (Eigen::Index i = 0; i < truth.rows(); ++i) {
    predictor.predict({inputs.row(i).data(), 2}, values, {}, scratch);
    for (Eigen::Index c = 0; c < truth.cols(); ++c) {
      error += std::pow(double{values[static_cast<std::size_t>(c)]} - truth(i, c), 2);
      departure += std::pow(mean(0, c) - truth(i, c), 2);
    }
  }

  EXPECT_NEAR(report_->fields[1].nrmse(0), std::sqrt(error / departure), 1e-12);
}

TEST_F(Accuracy, NoiseIsThatOfTheRepeatedRuns) {
  // 60 cells of variance 0.05^2; three runs estimate it within a few tenths.
  EXPECT_NEAR(report_->fields[0].noise.front(), 60 * 0.05 * 0.05, 0.5 * 60 * 0.05 * 0.05);
  EXPECT_LT(report_->fields[0].nrmse_without_noise(0), report_->fields[0].nrmse(0));
  EXPECT_NEAR(report_->fields[0].budget.nrmse_squared(), std::pow(report_->fields[0].nrmse(0), 2), 1e-12);
}

TEST(AccuracyOfAChangedStore, CasesThatLeftItAreNoDeadEnd) {
  const SmallStudy study(folder("changed"), {.n_held_out = 4});
  field::remove_cases(study.folder() / "snapshots.h5", {"load_13", "train_3"});
  test::RecordingLog log;

  EXPECT_ERROR(InputError, "case 'load_13', which the study held out, is missing in ",
               evaluate({.study = study.folder()}, log));
  EXPECT_ERROR(InputError, "judge on others by --cases", evaluate({.study = study.folder()}, log));
  EXPECT_ERROR(UsageError, "trained on case 'train_1'",
               evaluate({.study = study.folder(), .cases = {"train_1"}}, log));
  EXPECT_ERROR(UsageError, "holds no case 'lood_14'",
               evaluate({.study = study.folder(), .cases = {"lood_14"}}, log));

  const auto report = evaluate({.study = study.folder(), .cases = {"load_*"}}, log);
  ASSERT_EQ(report.cases.size(), 3U);
  EXPECT_EQ(report.cases[1].name, "load_14");
  EXPECT_EQ(report.n_training, SmallStudy::n_training - 1);
  EXPECT_THAT(log.text(), HasSubstr("not in the store any more: train_3;"));

  const auto curve = learning_curve(
      {.study = study.folder(), .cases = {"load_14"}, .method = "linear", .n_points = 2, .n_repeats = 1},
      log);
  EXPECT_EQ(curve.points.back().cases, SmallStudy::n_training - 1);
}

TEST(AccuracyOfAverages, FollowFromTheRunsByHand) {
  const SmallStudy study(folder("averages"), {.n_held_out = 1});  // the one load that has repeated runs
  // rep2 came into the store after the training: the study's split does not know it.
  auto split = study::read_split(study.folder() / "split.json");
  std::erase(split.held_out, "rep2");
  study::write_split(study.folder() / "split.json", split);

  const auto report = evaluate({.study = study.folder()}, silent_log());

  EXPECT_THAT(report.runs, ::testing::ElementsAre(3U));
  const auto store = field::SnapshotStore::open(study.folder() / "snapshots.h5");
  const std::array rows{store.find("load_*").front(), store.find("rep1").front(), store.find("rep2").front()};
  const MatrixD runs = store.read("pressure", rows).cast<double>(),
                training = store.read("pressure", store.find("train_*")).cast<double>();
  const Eigen::RowVectorXd truth = runs.colwise().mean(), mean = training.colwise().mean();
  const double noise = (runs.rowwise() - truth).squaredNorm() / 2 / 3;
  const model::Predictor predictor(study.folder() / "model.elrom", {.fields = {"pressure"}});
  model::Predictor::Scratch scratch;
  Eigen::RowVectorXf values(truth.size());
  const auto inputs = store.inputs(std::array{rows[0]});
  predictor.predict({inputs.data(), 2}, {values.data(), predictor.size()}, {}, scratch);
  const double error = (values.cast<double>() - truth).squaredNorm() - noise,
               departure = (mean - truth).squaredNorm() - noise;
  const double expected = std::copysign(std::sqrt(std::abs(error) / departure), error);
  EXPECT_NEAR(report.fields[1].averaged_nrmse(0, std::array{std::size_t{0}}), expected, 1e-6);
  EXPECT_FALSE(report.averaged_error(0).interval) << "of one case";
}

TEST_F(Accuracy, WithoutRepeatsOfEveryCaseThereAreNoAverages) {
  EXPECT_FALSE(report_->has_averaged_truth());
  EXPECT_TRUE(report_->fields[0].averaged_noise.empty());
}

TEST_F(Accuracy, CoverageIsMeasuredAtEveryPromisedLevel) {
  ASSERT_EQ(report_->fields[0].coverage.size(), coverage_levels.size());
  const double narrow = report_->mean_coverage(0), wide = report_->mean_coverage(2);
  EXPECT_GE(narrow, 0.0);
  EXPECT_LE(narrow, wide);
  EXPECT_LE(wide, 1.0);
}

TEST_F(Accuracy, TrainingTimesComeFromTheStudy) {
  EXPECT_EQ(report_->methods[0].file.train_seconds, 2.5);  // "auto", the default method
  EXPECT_EQ(report_->methods[1].file.train_seconds, 0.25);
  EXPECT_EQ(report_->methods[2].file.train_seconds, std::nullopt);
}

TEST_F(Accuracy, TerminalTableMarksTheBestWithoutColourToo) {
  const auto plain = terminal_table(*report_, false), coloured = terminal_table(*report_, true);

  EXPECT_THAT(plain, HasSubstr("*"));
  EXPECT_THAT(plain, Not(HasSubstr("\033[")));
  EXPECT_THAT(coloured, HasSubstr("\033["));
  EXPECT_THAT(plain, HasSubstr("solid volume fraction"));
}

TEST_F(Accuracy, JsonHoldsEveryFieldMethodAndCase) {
  const auto root = nlohmann::json::parse(to_json(*report_));

  EXPECT_EQ(root["kind"], "elrom-accuracy");
  EXPECT_EQ(root["fields"].size(), 3u);
  EXPECT_EQ(root["fields"][0]["methods"].size(), 3u);
  EXPECT_EQ(root["fields"][0]["methods"][0]["cases"].size(), 2u);
  EXPECT_DOUBLE_EQ(root["fields"][0]["methods"][0]["nrmse"], report_->fields[0].nrmse(0));
  EXPECT_EQ(root["cases"][0]["audit_prediction"]["planes"].size(), 5u);
  EXPECT_EQ(root["headline"], headline(*report_));
  EXPECT_EQ(root["leaked_cases"].size(), 0u);
  for (std::size_t k = 0; k < coverage_levels.size(); ++k) {
    const auto& level = root["fields"][0]["coverage"][k];
    EXPECT_EQ(level["promised"], coverage_levels[k]);
    ASSERT_EQ(level["by_case"].size(), 2u);
    const auto& measured = report_->fields[0].coverage[k];
    if (std::isnan(measured[1])) {  // the fixture's bundle has no intervals of 95 %
      EXPECT_TRUE(level["measured"].is_null());
      continue;
    }
    EXPECT_DOUBLE_EQ(level["by_case"][1], measured[1]);
    EXPECT_DOUBLE_EQ(level["measured"], (measured[0] + measured[1]) / 2);
  }
}

TEST_F(Accuracy, ChoiceIsToldAsTheBundleHasIt) {
  const auto& field = report_->fields[0];
  ASSERT_EQ(field.choice.candidates.size(), 4u);
  EXPECT_EQ(field.methods[0].detail, "nearest case 0.25, linear 0.75");
  EXPECT_TRUE(report_->fields[1].choice.candidates.empty());

  const auto root = nlohmann::json::parse(to_json(*report_))["fields"][0]["choice"];
  EXPECT_EQ(root["nrmse"], 0.4);
  EXPECT_EQ(root["nrmse_by_band"], 0.39);
  EXPECT_EQ(root["scale"], "primary_air^0");
  EXPECT_EQ(root["candidates"][1]["weight"], 0.75);
  EXPECT_EQ(root["candidates"][1]["left_after"], 0);
  EXPECT_EQ(root["candidates"][2]["left_after"], 1);
  EXPECT_TRUE(root["candidates"][3]["nrmse"].is_null());
  const auto page = html_page(*report_);
  const auto section = page.substr(page.find("id=\"choice\""));
  EXPECT_THAT(section, HasSubstr("<td class=\"mark best\">0.450</td><td class=\"mark\">~0.600</td>"
                                 "<td class=\"mark\">-</td>"));
  EXPECT_THAT(section, HasSubstr("<td>0.390</td><td>primary_air^0</td>"));
}

TEST_F(Accuracy, CsvHasOneLineAFieldMethodAndCase) {
  const auto text = to_csv(*report_);

  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 3 * 3 * (1 + 2));
}

TEST_F(Accuracy, PageNeedsNothingFromOutside) {
  const auto page = html_page(*report_);

  for (const auto* fetches : {"http://", "https://", "src=", "@import", "<link"})
    EXPECT_THAT(page, Not(HasSubstr(fetches)));
  EXPECT_THAT(page, HasSubstr("<h1>2 held-out runs"));
  // A number that is none would show in a path, an attribute or a cell.
  for (const auto* broken : {"Mnan", "Lnan", " nan", "=\"nan", ">nan<", ">inf<", "Minf", "Linf"})
    EXPECT_THAT(page, Not(HasSubstr(broken)));
  EXPECT_LT(page.size(), 8u << 20);
}

TEST_F(Accuracy, TheDescriptionGivesTheWords) {
  const auto page = html_page(*report_);

  EXPECT_THAT(page, HasSubstr("Vertical cuts: LES, prediction, difference"));
  EXPECT_THAT(page, Not(HasSubstr("EL3D")));
  EXPECT_THAT(terminal_table(*report_, false), HasSubstr("2 held-out runs"));
}

// Nobody described the cases, and none states a load: another problem than a furnace.
TEST(AccuracyElsewhere, WordsAreNeutralAndNothingIsMadeOfLoadsThatAreMissing) {
  const SmallStudy study(folder("elsewhere"), {.described = false, .with_loads = false});

  const auto report = evaluate({.study = study.folder(), .figures = true}, silent_log());
  const auto page = html_page(report), table = terminal_table(report, false);

  EXPECT_THAT(page, HasSubstr("Vertical cuts: reference, prediction, difference"));
  EXPECT_THAT(table, HasSubstr("held-out cases: mean NRMSE"));
  for (const auto* boiler :
       {"EL3D", "furnace", "Load", " loads", "against load", "% load", "inventory", "nan %", "inlets'"}) {
    EXPECT_THAT(page.substr(page.find("<body>"), page.find("<script>") - page.find("<body>")),
                Not(HasSubstr(boiler)));
    EXPECT_THAT(table, Not(HasSubstr(boiler)));
  }
}

TEST_F(Accuracy, ASmallLearningCurveIsShownOnlyWhereThereIsNoOther) {
  const auto curve_of = [](bool small) {
    const LearningPoint point{
        .cases = small ? 3U : 7U, .error_mean = 0.5, .error_std = 0.1, .field_error = {{"pressure", 0.5}}};
    return to_json(
        {.study = "s", .method = "linear", .points = {point}, .small = small, .v1 = point, .v2 = point});
  };
  base::write_text(study_->folder() / "learning-curve-small.json", curve_of(true));
  const auto quick = html_page(*report_, find_extras(report_->study));
  base::write_text(study_->folder() / "learning-curve.json", curve_of(false));
  const auto full = html_page(*report_, find_extras(report_->study));

  EXPECT_THAT(quick, HasSubstr("A quick look"));
  EXPECT_THAT(full, Not(HasSubstr("A quick look")));
  EXPECT_THAT(full, HasSubstr("v2, 7 cases"));
}

TEST_F(Accuracy, EveryLinkOfThePageHasItsTarget) {
  const auto page = html_page(*report_);
  std::size_t links = 0;
  for (auto at = page.find("href=\"#"); at != std::string::npos;
       at = page.find("href=\"#", at + 1), ++links) {
    const auto begin = at + 7;
    EXPECT_THAT(page, HasSubstr("id=\"" + page.substr(begin, page.find('"', begin) - begin) + "\""));
  }
  EXPECT_GE(links, 8u);
}

TEST_F(Accuracy, PageEscapesNamesFromOutside) {
  AccuracyReport report = *report_;
  report.cases[0].name = "<script>alert(1)</script>";
  report.study.name = "a & \"b\"";

  const auto page = html_page(report);

  EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
  EXPECT_THAT(page, HasSubstr("a &amp; &quot;b&quot;"));
}

TEST_F(Accuracy, PageShowsTheSearch) {
  networks::TrialStore::Search search{.digest = "d", .name = "pressure, 0 to 0.1", .trials = {}};
  for (int i = 0; i < 6; ++i)
    search.trials.push_back(
        {.hyperparameters = {.n_units = 16 << i}, .value = 0.5 - 0.05 * i, .epochs = 10, .rungs = {}});

  const auto page = html_page(*report_, {.searches = {search}});

  EXPECT_THAT(page, HasSubstr("6 trials in one search."));
  EXPECT_THAT(page, HasSubstr("History of pressure, 0 to 0.1"));
  EXPECT_THAT(page, HasSubstr("Importance of hyperparameters"));
  EXPECT_THAT(page, HasSubstr("Slice: units"));
  EXPECT_THAT(page, Not(HasSubstr("Slice: layers"))) << "one value is no slice";
}

TEST_F(Accuracy, AnUntrainedDirectoryIsRefusedWithTheCommandThatTrainsIt) {
  const auto empty = folder("untrained");
  std::filesystem::create_directories(empty);

  try {
    (void)evaluate({.study = empty}, silent_log());
    FAIL() << "accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("elrom-train run"));
  }
}

TEST_F(Accuracy, StudiesAreComparedByCost) {
  const auto cost = cost_report({.studies = {study_->folder()}}, silent_log());

  ASSERT_EQ(cost.points.size(), 3u);
  EXPECT_EQ(cost.points[0].train_seconds, 2.5);
  EXPECT_DOUBLE_EQ(cost.points[0].error, report_->methods[0].mean_nrmse);
}

TEST_F(Accuracy, LearningCurveEndsAtAllCasesAndHoldsTheSourcesComparison) {
  const auto curve = learning_curve(
      {.study = study_->folder(), .method = "linear", .n_points = 3, .n_repeats = 2}, silent_log());

  EXPECT_EQ(curve.points.back().cases, 12u);
  EXPECT_EQ(curve.v1.cases, 4u);
  EXPECT_EQ(curve.v2.cases, 12u);
  EXPECT_EQ(curve.points.back().error_std, 0.0);  // all cases: every draw is the same
  // All cases with the linear peer: what the peer's own bundle scores.
  EXPECT_NEAR(curve.v2.error_mean, report_->methods[2].mean_nrmse, 1e-5);
  EXPECT_GT(curve.v1.error_mean, curve.v2.error_mean);
}

TEST_F(Accuracy, LearningCurveRefusesAnUnknownMethodWithANearName) {
  try {
    (void)learning_curve({.study = study_->folder(), .method = "linaer"}, silent_log());
    FAIL() << "accepted";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean 'linear'?"));
  }
}

}  // namespace
}  // namespace elrom::report
