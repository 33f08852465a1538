#include "elrom/report/cost.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/report/learning_curve.hpp"
#include "small_study.hpp"
#include "support/throws.hpp"

namespace elrom::report {
namespace {

std::filesystem::path file(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / (std::to_string(::getpid()) + name);
}

TEST(Cost, FrontLeavesOutWhatAnotherBeatsInEverything) {
  std::vector<CostPoint> points{{.name = "accurate", .error = 0.6, .train_seconds = 100, .predict_ms = 9},
                                {.name = "fast", .error = 0.9, .train_seconds = 1, .predict_ms = 1},
                                {.name = "beaten", .error = 0.9, .train_seconds = 2, .predict_ms = 1},
                                {.name = "unknown time", .error = 0.95, .predict_ms = 0.5}};

  mark_front(points);

  EXPECT_TRUE(points[0].front);
  EXPECT_TRUE(points[1].front);
  EXPECT_FALSE(points[2].front);
  EXPECT_TRUE(points[3].front);
}

TEST(Cost, EqualPointsBothStayOnTheFront) {
  std::vector<CostPoint> points(2, {.name = "twin", .error = 0.6, .train_seconds = 1, .predict_ms = 1});

  mark_front(points);

  EXPECT_TRUE(points[0].front && points[1].front);
}

CostReport report_with_networks(int fields_used) {
  CostReport report{
      .points = {{.name = "study", .error = 0.629, .train_seconds = 250, .predict_ms = 12},
                 {.name = "study: networks", .error = 0.634, .train_seconds = 45, .predict_ms = 30}},
      .reference = {.name = "EL3D", .hours = 23, .cores = 48, .error = 0.602, .n_cases = 64},
      .parts = {{.study = "study",
                 .method = "kernel",
                 .processor_seconds = 40,
                 .fields = 9,
                 .fields_used = 9,
                 .error = std::nan("")},
                {.study = "study",
                 .method = "networks",
                 .processor_seconds = 210,
                 .fields = 9,
                 .fields_used = fields_used,
                 .error = 0.634}}};
  report.points.front().train_processor_seconds = 250;
  mark_front(report.points);
  return report;
}

TEST(Cost, WordsSayWhatBuysNothing) {
  EXPECT_THAT(
      in_words(report_with_networks(0)),
      ::testing::Contains("networks cost 3 min 30 s of processor time here and buy nothing (0.634 against "
                          "0.629): leave them out (peers.networks = false)."));
  EXPECT_THAT(in_words(report_with_networks(2)),
              ::testing::Contains(::testing::HasSubstr("answer, alone or blended, for 2 of 9 fields")));
}

TEST(Cost, WordsSetTheSolverBesideTheModel) {
  const auto words = in_words(report_with_networks(0));

  // 23 h * 48 cores = 3,974,400 s; 12 ms and 250 s beside them
  EXPECT_THAT(words,
              ::testing::Contains("EL3D takes 23 h on 48 cores for one case; a prediction takes 12.0 ms on "
                                  "one, 3e+08 times less, and the training 4 min 10 s, 0.0063 % of one case "
                                  "(its 64 training cases took 7.07e+04 core hours)."));
  auto unknown = report_with_networks(0);
  unknown.reference.hours = 0;
  EXPECT_EQ(in_words(unknown).size(), words.size() - 1);
}

TEST(Cost, TheFrontIsByProcessorTimeWhereItWasKept) {
  std::vector<CostPoint> points{{.name = "a", .error = 0.6, .train_seconds = 100, .predict_ms = 1},
                                {.name = "b", .error = 0.6, .train_seconds = 50, .predict_ms = 1}};
  points[0].train_processor_seconds = 10;
  points[1].train_processor_seconds = 20;

  mark_front(points);

  EXPECT_TRUE(points[0].front);
  EXPECT_FALSE(points[1].front);
}

TEST(Cost, PartsAndReferenceReadBackTheSame) {
  base::write_text(file("parts.json"), to_json(report_with_networks(0)));

  const auto read = read_cost_report(file("parts.json"));

  EXPECT_EQ(read.points.front().train_processor_seconds, 250);
  EXPECT_EQ(in_words(read), in_words(report_with_networks(0)));
}

TEST(Cost, AStudyTellsItsPointsItsPartsAndWhatItWouldCostBare) {
  const SmallStudy study(file("cost-study"));
  base::write_text(study.folder() / "timing.json", R"({"kind": "elrom-timing", "format": [1, 1], "stages": {},
      "methods": {"linear": 3, "nearest": 0.25}, "method_processor_seconds": {"linear": 4, "nearest": 0.5},
      "candidates": {"linear": {"seconds": 1, "processor_seconds": 1},
                     "networks": {"seconds": 2, "processor_seconds": 3}}})");
  const auto report = cost_report(
      {.studies = {study.folder()}, .reference = {.name = "CFD", .hours = 2, .cores = 10}}, silent_log());

  const auto& model = report.points.front();
  EXPECT_EQ(model.train_processor_seconds, 4);
  EXPECT_GT(model.predict_ms, 0);
  EXPECT_GT(model.error_deviation, 0);
  EXPECT_EQ(report.parts.size(), 2u);
  EXPECT_EQ(report.reference.n_cases, static_cast<double>(SmallStudy::n_training));
  EXPECT_GT(report.reference.error, 0) << "the scatter of its repeated runs";
  EXPECT_THAT(in_words(report), ::testing::Contains(::testing::HasSubstr("networks cost 3.0 s")));
  EXPECT_THAT(report.points.back().name, ::testing::EndsWith(": linear alone"));
  EXPECT_EQ(report.points.back().train_processor_seconds, 1);
}

TEST(Cost, SizesAreFittedAloneAndRememberedButStandOnNoFront) {
  const SmallStudy study(file("sizes-study"));
  const auto report = cost_report({.studies = {study.folder()}, .sizes = true}, silent_log());
  base::write_text(file("sizes.json"), to_json(report));

  const auto read = read_cost_report(file("sizes.json"));

  std::vector<std::size_t> linear;
  for (const auto& point : read.points) {
    if (point.cases == 0) continue;
    EXPECT_TRUE(std::isnan(point.predict_ms));
    EXPECT_FALSE(point.front);
    EXPECT_TRUE(point.train_processor_seconds);
    if (point.name.find(": linear, ") != std::string::npos) linear.push_back(point.cases);
  }
  EXPECT_THAT(linear, ::testing::ElementsAre(4, SmallStudy::n_training));
  EXPECT_THAT(in_words(read), ::testing::Contains(::testing::HasSubstr("By the number of cases the kernel")));
  EXPECT_THAT(terminal_table(read), ::testing::HasSubstr("not timed"));
}

TEST(Cost, JsonReadsBackTheSame) {
  const CostReport written{.points = {{.name = "a: \"b\"", .error = 0.25, .predict_ms = 3.5, .front = true}},
                           .reference = {},
                           .parts = {}};
  base::write_text(file("cost.json"), to_json(written));

  const auto read = read_cost_report(file("cost.json"));

  ASSERT_EQ(read.points.size(), 1u);
  EXPECT_EQ(read.points[0].name, "a: \"b\"");
  EXPECT_EQ(read.points[0].train_seconds, std::nullopt);
  EXPECT_TRUE(read.points[0].front);
}

TEST(Cost, AForeignFileIsRefusedByName) {
  base::write_text(file("foreign.json"), "{\"points\": 3}");

  EXPECT_THROW((void)read_cost_report(file("foreign.json")), InputError);
}

TEST(Cost, ReadersOfReportsTakeNewerMinorVersionsAndRefuseNewerMajorOnes) {
  const auto with_version = [](const std::string& text, const std::string& version) {
    auto root = nlohmann::json::parse(text);
    root["format"] = nlohmann::json::parse(version);
    base::write_text(file("versioned.json"), root.dump());
    return file("versioned.json");
  };
  const LearningPoint point{
      .cases = 4, .error_mean = 0.5, .error_std = 0.1, .field_error = {{"pressure", 0.5}}};
  const auto curve = to_json({.study = "s", .method = "linear", .points = {point}, .v1 = point, .v2 = point});
  const auto cost = to_json(CostReport{});

  EXPECT_NO_THROW((void)read_learning_curve(with_version(curve, "[1, 7]")));
  EXPECT_NO_THROW((void)read_cost_report(with_version(cost, "[1, 7]")));
  EXPECT_ERROR(InputError, "found elrom-learning-curve 2.0",
               read_learning_curve(with_version(curve, "[2, 0]")));
  EXPECT_ERROR(InputError, "found elrom-cost 2.0", read_cost_report(with_version(cost, "[2, 0]")));
  EXPECT_ERROR(InputError, "expected elrom-learning-curve",
               read_learning_curve(with_version(cost, "[1, 0]")));
  EXPECT_ERROR(InputError, "expected elrom-cost", read_cost_report(with_version(curve, "[1, 0]")));
}

}  // namespace
}  // namespace elrom::report
