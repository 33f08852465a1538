#include "elrom/report/learning_curve.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/log.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "report/small_study.hpp"

namespace elrom::report {
namespace {

using ::testing::HasSubstr;

std::filesystem::path curve_file(const std::string& name) {
  return std::filesystem::path(::testing::TempDir()) / (std::to_string(::getpid()) + name);
}

TEST(PowerLaw, RecoversTheLawThatMadeThePoints) {
  std::vector<double> cases{8, 16, 32, 64}, errors;
  for (const double n : cases) errors.push_back(0.5 + 2 * std::pow(n, -0.8));

  const auto law = fit_power_law(cases, errors);

  EXPECT_NEAR(law.rate, 0.8, 1e-9);  // on the grid of rates
  EXPECT_NEAR(law.floor, 0.5, 1e-9);
  EXPECT_NEAR(law.at(84), 0.5 + 2 * std::pow(84, -0.8), 1e-9);
}

TEST(PowerLaw, ErrorsThatRisePromiseNoGain) {
  const auto law = fit_power_law({10, 20, 40}, {0.5, 0.6, 0.7});

  EXPECT_DOUBLE_EQ(law.at(60), law.at(40));
}

TEST(PowerLaw, KnowsWhenThePointsAskForMoreThanItCanGive) {
  const std::vector<double> cases{8, 16, 32, 64};
  const auto law_of = [&](double rate) {
    std::vector<double> errors;
    for (const double n : cases) errors.push_back(0.2 + 3 * std::pow(n, -rate));
    return fit_power_law(cases, errors);
  };

  EXPECT_FALSE(law_of(0.5).at_bound());
  EXPECT_TRUE(law_of(4).at_bound());
  EXPECT_TRUE(fit_power_law(cases, {1.0, 0.98, 0.9, 0.6}).at_bound()) << "ever steeper";
  EXPECT_TRUE(fit_power_law(cases, {0.5, 0.6, 0.7, 0.8}).at_bound());
}

TEST(LearningCurve, AFitAtItsBoundPromisesNothing) {
  LearningCurve curve{.study = "s", .method = "linear"};
  curve.points = {{.cases = 4, .error_mean = 0.5, .error_std = 0.1, .field_error = {{"pressure", 0.5}}}};
  curve.v1 = curve.v2 = curve.points.front();
  curve.fit = {0, 1, PowerLaw::least_rate};
  curve.gain_next_20 = 0.5;  // as older files have it

  base::write_text(curve_file("bound.json"), to_json(curve));
  const auto read = read_learning_curve(curve_file("bound.json"));

  EXPECT_TRUE(std::isnan(read.gain_next_20));
  EXPECT_THAT(outlook(read), ::testing::HasSubstr("cannot be told"));
  EXPECT_THAT(terminal_table(read), ::testing::Not(::testing::HasSubstr("expected to lower")));
  EXPECT_TRUE(nlohmann::json::parse(to_json(read))["fit"]["at_bound"]);
}

TEST(LearningCurve, JsonReadsBackTheSame) {
  LearningCurve curve{.study = "s", .method = "linear"};
  curve.points = {{.cases = 4, .error_mean = 0.5, .error_std = 0.1, .field_error = {{"pressure", 0.5}}}};
  curve.v1 = curve.v2 = curve.points.front();
  curve.fit = {0.1, 1, 0.5};
  curve.gain_next_20 = 0.03;
  curve.small = true;
  base::write_text(curve_file("curve.json"), to_json(curve));

  const auto read = read_learning_curve(curve_file("curve.json"));

  EXPECT_EQ(read.method, "linear");
  EXPECT_EQ(read.points.front().field_error.at("pressure"), 0.5);
  EXPECT_EQ(read.gain_next_20, 0.03);
  EXPECT_TRUE(read.small);
}

TEST(PowerLaw, TellsHowManyCasesAnErrorTakes) {
  const PowerLaw law{0.2, 3, 0.5};

  EXPECT_NEAR(law.at(law.cases_for(0.25).value()), 0.25, 1e-12);
  EXPECT_DOUBLE_EQ(law.cases_for(0.5).value(), 100);  // 3 / sqrt(100) above the floor
  EXPECT_FALSE(law.cases_for(0.2)) << "the floor";
  EXPECT_FALSE((PowerLaw{0, 3, 0.5}.cases_for(0.25))) << "at its bound";
}

// Two fields whose shares lie on their lines: clean 0.04 and 0.09, noise 0.12 and 0.07.
AveragingCurve averaged_longer() {
  MatrixD shares(2, 3);
  shares << 0.16, 0.28, 0.40, 0.16, 0.23, 0.30;
  return fit_averaging({"a", "b"}, {1, 2, 3}, shares);
}

TEST(AveragingCurve, DrawsTheErrorBackToLessNoise) {
  const auto curve = averaged_longer();

  EXPECT_NEAR(curve.fields.at("a").clean, 0.04, 1e-12);
  EXPECT_NEAR(curve.fields.at("b").noise, 0.07, 1e-12);
  EXPECT_NEAR(curve.at(1), 0.4, 1e-12);
  EXPECT_NEAR(curve.at(HUGE_VAL), (0.2 + 0.3) / 2, 1e-12);
  EXPECT_NEAR(curve.at(2), (std::sqrt(0.1) + std::sqrt(0.125)) / 2, 1e-12);
  EXPECT_NEAR(curve.levels[2].error_mean, (std::sqrt(0.4) + std::sqrt(0.3)) / 2, 1e-12);
}

TEST(AveragingCurve, TellsHowMuchLongerAnErrorTakes) {
  const auto curve = averaged_longer();

  EXPECT_NEAR(curve.factor_for(curve.at(3.5)).value(), 3.5, 1e-9);
  EXPECT_DOUBLE_EQ(curve.factor_for(0.5).value(), 1) << "reached already";
  EXPECT_FALSE(curve.factor_for(0.25)) << "that of cases without noise";
  EXPECT_FALSE(AveragingCurve().factor_for(1));
}

LearningCurve bought() {
  LearningCurve curve{.study = "s", .method = "linear"};
  curve.points = {{.cases = 64,
                   .error_mean = 0.5,
                   .field_error = {{"a", 0.5}},
                   .averaged_mean = 0.4,
                   .averaged_std = 0.01}};
  curve.v1 = curve.v2 = curve.points.front();
  curve.averaged_fit = {0.2, 1.6, 0.5};  // 0.4 at 64
  curve.averaging = averaged_longer();
  curve.price = {"EL3D", 23, 10};
  return curve;
}

TEST(Purchases, AreTheInverseOfBothCurvesWithinReach) {
  const auto curve = bought();

  const auto ways = purchases(curve, {0.36, 0.26, 0.1});

  EXPECT_NEAR(ways[0].cases.value(), 100, 1e-9);  // 1.6 / sqrt(100) + 0.2
  EXPECT_NEAR(curve.averaging.at(ways[0].averaging.value()), 0.36, 1e-9);
  EXPECT_FALSE(ways[1].cases) << "711 are more than ten times 64";
  EXPECT_FALSE(ways[2].cases);
  EXPECT_FALSE(ways[2].averaging);
  EXPECT_EQ(purchases(curve).size(), 4U);
  EXPECT_NEAR(purchases(curve).front().error, 0.36, 1e-12);
  EXPECT_TRUE(purchases({}).empty());
}

TEST(Purchases, CostHoursBeyondThoseSpent) {
  const auto curve = bought();

  EXPECT_DOUBLE_EQ(hours_of_cases(curve, 99.2), 36 * 23) << "whole cases";
  EXPECT_DOUBLE_EQ(hours_of_averaging(curve, 1.5), 64 * 13 * 0.5) << "without the start-up";
  EXPECT_THAT(purchase_table(curve, {0.3601}), HasSubstr("100 in all      828 h"));
  EXPECT_THAT(purchase_table({}), HasSubstr("not every held-out case has repeated runs"));
}

TEST(LearningCurve, BothWaysReadBackTheSame) {
  const auto curve = bought();
  base::write_text(curve_file("ways.json"), to_json(curve));

  const auto read = read_learning_curve(curve_file("ways.json"));

  EXPECT_EQ(read.v2.averaged_mean, 0.4);
  EXPECT_EQ(read.price.start_up, 10);
  EXPECT_EQ(purchase_table(read), purchase_table(curve));
}

// Of least squares, the noise of the cases comes through by the leverage of what is predicted.
TEST(LearningCurve, AddedNoiseComesThroughByTheMethodsLeverage) {
  const SmallStudy study(curve_file("leverage"), {.n_held_out = 1});  // the load that has repeated runs

  const auto curve = learning_curve({.study = study.folder(),
                                     .method = "linear",
                                     .fields = {"gas_velocity_z"},
                                     .n_points = 2,
                                     .n_repeats = 8},
                                    silent_log());

  const auto store = field::SnapshotStore::open(study.folder() / "snapshots.h5");
  const auto training = store.find("train_*"), runs = store.find("load_*");
  MatrixD design(12, 3);
  design << MatrixD::Ones(12, 1), store.inputs(training);
  Eigen::RowVector3d at;
  at << 1, store.inputs(runs);
  const double leverage = at.dot(math::Cholesky(design.transpose() * design).solve(at.transpose()).col(0));
  const MatrixD values = store.read("gas_velocity_z", training).cast<double>(),
                truth = store.read("gas_velocity_z", runs).cast<double>();
  constexpr double sigma = 0.05;  // of the made-up runs
  const double expected = leverage * sigma * sigma * static_cast<double>(truth.cols()) /
                          (values.colwise().mean() - truth).squaredNorm();
  EXPECT_NEAR(curve.averaging.fields.at("gas_velocity_z").noise, expected, 0.5 * expected);
  EXPECT_NEAR(curve.averaging.levels.front().error_mean, curve.v2.averaged_mean, 1e-12);
}

}  // namespace
}  // namespace elrom::report
