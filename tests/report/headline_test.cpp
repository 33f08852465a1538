#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/math/statistics.hpp"
#include "elrom/report/accuracy.hpp"
#include "elrom/report/page.hpp"
#include "report/small_study.hpp"

namespace elrom::report {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

std::filesystem::path headline_folder(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) /
         ("elrom-headline-" + name + "-" + std::to_string(::getpid()));
}

/// A method's NRMSE of a field in six cases, each of departure 1.
MethodField scores(const std::vector<double>& nrmse) {
  MethodField method{.available = true, .kind = "kernel"};
  for (const double one : nrmse) {
    method.cases.push_back({.n = 10, .error = one * one, .departure = 1});
    method.pooled += method.cases.back();
    method.worst.emplace_back();
  }
  return method;
}

/// ELROM, networks, and a simple peer in two fields.
AccuracyReport two_fields() {
  AccuracyReport report;
  report.cases.resize(6);
  for (std::size_t i = 0; i < 6; ++i) report.cases[i].name = "case_" + std::to_string(i);
  for (const auto* name : {"ELROM", "networks", "linear"})
    report.methods.push_back({.file = {.name = name, .is_peer = std::string(name) == "linear"}});
  for (const auto* name : {"pressure", "gas_velocity_z"}) {
    FieldAccuracy field;
    field.info.name = name;
    field.methods = {scores({.50, .48, .52, .50, .47, .53}), scores({.6, .6, .6, .6, .6, .6}),
                     scores({.70, .66, .74, .70, .69, .71})};
    report.fields.push_back(field);
  }
  for (std::size_t m = 0; m < 3; ++m) report.methods[m].mean_nrmse = report.fields[0].nrmse(m);
  return report;
}

TEST(Headline, SaysWhatIsComparedAndHowSureTheGainIs) {
  const auto report = two_fields();
  const auto gain = report.gain();

  // All six cases agree: about 1 - 0.5 / 0.7, and the interval within what single cases have.
  ASSERT_TRUE(gain.interval);
  EXPECT_NEAR(gain.value, 1 - .5 / .7, 0.01);
  EXPECT_GT(gain.interval->low, 1 - .53 / .71);
  EXPECT_LT(gain.interval->high, 1 - .47 / .69 + 0.01);
  EXPECT_EQ(gain.verdict(), Gain::Verdict::better);
  EXPECT_THAT(headline(report), ::testing::ContainsRegex(
                                    "6 held-out cases: mean NRMSE 0.500 over 2 fields, 28.[0-9] % \\(90 % "
                                    "interval 2[0-9.]* to [0-9.]* %\\) below the best single peer, linear"));
}

TEST(Headline, AGainThatTheCasesDoNotShowIsCalledSo) {
  auto report = two_fields();
  for (auto& field : report.fields) field.methods[0] = scores({.50, .90, .40, .95, .60, .70});

  EXPECT_EQ(report.gain().verdict(), Gain::Verdict::not_shown);
  EXPECT_THAT(headline(report), HasSubstr("no difference shown"));
}

TEST(Headline, NetworksThatAreBetterAreCounted) {
  auto report = two_fields();
  EXPECT_THAT(headline(report), HasSubstr("no other method is better in any field"));

  report.fields[1].methods[1] = scores({.4, .4, .4, .4, .4, .4});

  EXPECT_THAT(headline(report),
              HasSubstr("another method is better in gas velocity z (networks 0.400 against"));
  EXPECT_EQ(report.fields_won(), 2U) << "of simple peers";
  EXPECT_EQ(report.fields_won_against_all(), 1U);
  const auto root = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(root["headline"], headline(report));
  EXPECT_EQ(root["fields_at_or_below_every_method"], 1);
  EXPECT_EQ(root["methods"][1]["fields_better_than_study"], 1);
}

TEST(Headline, TooFewCasesForAnIntervalIsSaid) {
  auto report = two_fields();
  report.cases.resize(2);
  for (auto& field : report.fields)
    for (auto& method : field.methods) method.cases.resize(2);

  EXPECT_FALSE(report.gain().interval);
  EXPECT_THAT(headline(report), HasSubstr("too few cases for an interval"));
}

/// Errors and departures hold `noise` beside what is left: r^2 for each method, 1 for the departure.
void average_truths(AccuracyReport& report, double noise, const std::vector<double>& nrmse) {
  report.runs.assign(report.cases.size(), 4);
  for (auto& field : report.fields) {
    field.averaged_noise.assign(report.cases.size(), noise);
    for (std::size_t m = 0; m < nrmse.size(); ++m)
      field.methods[m].averaged.assign(
          report.cases.size(), {.n = 10, .error = nrmse[m] * nrmse[m] + noise, .departure = 1 + noise});
  }
}

TEST(Headline, AveragedTruthsAreTheMeasureWhereEveryCaseHasThem) {
  auto report = two_fields();
  EXPECT_THAT(headline(report), Not(HasSubstr("averaged")));
  EXPECT_TRUE(std::isnan(report.averaged_error(0).value));
  average_truths(report, 0.2, {0.3, 0.4, 0.6});

  EXPECT_NEAR(report.averaged_error(0).value, 0.3, 1e-12);
  EXPECT_NEAR(report.averaged_gain().value, 0.5, 1e-12);
  EXPECT_THAT(
      headline(report),
      ::testing::StartsWith("Truths averaged over 4 runs each, the noise left in them taken off: mean "
                            "NRMSE 0.300 (90 % interval 0.300 to 0.300), 50.0 % (90 % interval 50.0 to "
                            "50.0 %) below the best single peer, linear (0.600). Against single runs: "));
  EXPECT_THAT(terminal_table(report, false), HasSubstr("mean, averaged truths"));
  const auto root = nlohmann::json::parse(to_json(report));
  EXPECT_NEAR(root["averaged_truth"]["methods"][0]["mean_nrmse"].get<double>(), 0.3, 1e-12);
  EXPECT_EQ(root["averaged_truth"]["best_single_peer"], "linear");
  EXPECT_NEAR(root["fields"][0]["methods"][2]["nrmse_averaged_truth"].get<double>(), 0.6, 1e-12);
}

TEST(Headline, AnErrorBelowTheNoiseOfAveragedTruthsIsNegativeNotZero) {
  auto report = two_fields();
  average_truths(report, 0.2, {0.3, 0.4, 0.6});
  for (auto& sums : report.fields[0].methods[0].averaged) sums.error = 0.2 - 0.04;

  EXPECT_NEAR(report.fields[0].averaged_nrmse(0, math::all_rows(6)), -0.2, 1e-12);
  EXPECT_NEAR(report.averaged_error(0).value, (0.3 - 0.2) / 2, 1e-12);
}

TEST(Headline, NothingIsClaimedOfErrorsBelowTheNoise) {
  auto report = two_fields();
  report.repeats = {"case_0", "rep1"};
  for (auto& field : report.fields) field.noise.assign(6, 0.1);  // of errors about 0.25
  for (auto& method : report.methods) method.mean_nrmse_without_noise = 0.4;
  EXPECT_TRUE(std::isfinite(report.gain_without_noise()));
  EXPECT_EQ(report.fields_above_noise(), 2U);

  report.fields[0].noise.assign(6, 0.3);  // above ELROM's error, below its peers'

  EXPECT_TRUE(std::isnan(report.gain_without_noise()));
  EXPECT_TRUE(report.fields[0].below_noise(0));
  EXPECT_FALSE(report.fields[0].below_noise(2));
  EXPECT_TRUE(std::isnan(report.fields[0].nrmse_without_noise(0)));
  const auto table = terminal_table(report, false);
  EXPECT_THAT(table, HasSubstr("below the measured noise in 1 of 2 fields"));
  EXPECT_THAT(table, HasSubstr("1 of 2, noise taken off"));
  EXPECT_THAT(table, Not(HasSubstr("with it taken off")));
  const auto root = nlohmann::json::parse(to_json(report));
  EXPECT_EQ(root["fields_below_noise"], 1);
  EXPECT_TRUE(root["gain_without_noise"].is_null());
  EXPECT_TRUE(root["fields"][0]["methods"][0]["below_noise"]);
}

// A bundle that had seen all cases shines; the report must not.
TEST(HeadlineOfAStudy, BundlesOfOtherCasesAndOfHeldOutOnesAreMarked) {
  const SmallStudy study(headline_folder("unlike"));
  study.train("linear", {"train_*", "load_*"}, study.folder() / "model.elrom");
  study.train("nearest", {"train_?"}, study.folder() / "fewer.elrom");
  study.train("linear", {"train_*", "rep1"}, study.folder() / "knows.elrom");

  const auto report = evaluate({.study = study.folder(),
                                .against = {study.folder() / "fewer.elrom", study.folder() / "knows.elrom"},
                                .figures = true},
                               silent_log());

  EXPECT_EQ(report.title(0), "ELROM (14 cases, saw 2 held out)");
  EXPECT_EQ(report.title(1), "nearest case");
  EXPECT_EQ(report.title(3), "fewer (10 cases)");
  EXPECT_THAT(report.methods[4].leaked_cases, ElementsAre("load_12")) << "rep1 has its boundary conditions";
  for (const auto& text : {headline(report), terminal_table(report, false), html_page(report)}) {
    EXPECT_THAT(text, HasSubstr("ELROM was trained on held-out runs (load_12, load_13)"));
    EXPECT_THAT(text, HasSubstr("Not like for like, by training cases: ELROM from 14; knows from 13; nearest "
                                "case, linear from 12; fewer from 10."));
  }
  EXPECT_THAT(terminal_table(report, false), HasSubstr("saw 2 held out"));
  EXPECT_THAT(html_page(report), HasSubstr("<th>ELROM (14 cases, saw 2 held out)</th>"));
  const auto root = nlohmann::json::parse(to_json(report));
  EXPECT_THAT(root["leaked_cases"], ElementsAre("load_12", "load_13"));
  EXPECT_EQ(root["methods"][3]["training_cases"], 10);
  EXPECT_TRUE(root["methods"][3]["other_training_cases"]);
  EXPECT_FALSE(root["methods"][1]["other_training_cases"]);
}

}  // namespace
}  // namespace elrom::report
