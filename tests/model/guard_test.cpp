#include "elrom/model/guard.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"

namespace elrom::model {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Load drives both flows together; a third input is the same in every case.
struct Cases {
  field::InputSchema schema{{{"air", "kg/s", "t/h"}, {"fuel", "kg/s", "kg/s"}, {"d50", "m", "um"}}};
  MatrixD inputs = MatrixD(40, 3);
  std::vector<std::string> names;
  std::vector<double> loads;

  Cases() {
    base::Random random(base::Seed(3));
    for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
      const double load = 0.4 + 0.6 * static_cast<double>(i) / 39;
      inputs.row(i) << 200 * load + random.uniform(-4, 4), 20 * load + random.uniform(-0.4, 0.4), 180e-6;
      names.push_back("train_" + std::to_string(i));
      loads.push_back(load);
    }
  }
  [[nodiscard]] Guard guard() const { return {schema, inputs, names, loads}; }
};

TEST(Guard, ACaseAmongTheTrainingCasesIsInside) {
  const Cases cases;

  const auto result = cases.guard().assess(std::array{140.0, 14.0, 180e-6});

  EXPECT_EQ(result.verdict, Verdict::inside);
  EXPECT_THAT(result.out_of_range, ElementsAre());
  EXPECT_GT(result.p_value, 0.1);
}

TEST(Guard, TrainingCasesFindThemselvesAsNearest) {
  const Cases cases;
  const auto guard = cases.guard();

  for (Eigen::Index i = 0; i < cases.inputs.rows(); ++i) {
    const Eigen::RowVectorXd row = cases.inputs.row(i);
    const auto result = guard.assess({row.data(), 3});
    ASSERT_EQ(result.nearest.size(), 3U);
    EXPECT_EQ(result.nearest[0].name, cases.names[static_cast<std::size_t>(i)]);
    EXPECT_EQ(result.nearest[0].distance, 0);
    EXPECT_LE(result.nearest[1].distance, result.nearest[2].distance);
    EXPECT_NE(result.verdict, Verdict::outside);
  }
}

TEST(Guard, TellsTheTrainedRangeOfEachInput) {
  const Cases cases;
  const auto guard = cases.guard();

  for (Eigen::Index j = 0; j < 3; ++j) {
    EXPECT_EQ(guard.low()[static_cast<std::size_t>(j)], cases.inputs.col(j).minCoeff());
    EXPECT_EQ(guard.high()[static_cast<std::size_t>(j)], cases.inputs.col(j).maxCoeff());
  }
}

TEST(Guard, AnInputFarOutOfRangeIsOutsideAndNamedInTheUsersUnit) {
  const auto result = Cases().guard().assess(std::array{300.0, 14.0, 180e-6});

  EXPECT_EQ(result.verdict, Verdict::outside);
  ASSERT_EQ(result.out_of_range.size(), 1U);
  EXPECT_THAT(result.out_of_range[0], HasSubstr("air 1080 t/h (trained "));
  EXPECT_THAT(result.reason, HasSubstr("outside the trained range"));
}

TEST(Guard, JustBeyondTheRangeIsEdge) {
  const Cases cases;
  const double high = cases.inputs.col(0).maxCoeff(), width = high - cases.inputs.col(0).minCoeff();

  const auto result =
      cases.guard().assess(std::array{high + 0.05 * width, cases.inputs.col(1).maxCoeff(), 180e-6});

  EXPECT_EQ(result.verdict, Verdict::edge);
}

// Few cases lie far outside each other's range, and once told nothing of one that lies 22 % outside theirs.
TEST(Guard, AFifthOfTheTrainedWidthOutsideIsOutsideHoweverFewCasesTell) {
  Cases cases;
  cases.inputs.col(2).setConstant(100e-6);
  cases.inputs(20, 2) = 200e-6;  // a whole width outside the others' range
  const auto at = [&](double d50) { return cases.guard().assess(std::array{140.0, 14.0, d50}); };

  EXPECT_NE(at(219e-6).verdict, Verdict::outside) << at(219e-6).reason;
  const auto result = at(222e-6);
  EXPECT_EQ(result.verdict, Verdict::outside);
  EXPECT_THAT(result.reason,
              HasSubstr("d50 222 um (trained 100 to 200, 22 % of that width outside) lies outside"));
}

TEST(Guard, SaysHowFarOutsideTheRangeAnInsideCaseLies) {
  Cases cases;
  base::Random random(base::Seed(5));
  for (Eigen::Index i = 0; i < cases.inputs.rows(); ++i) cases.inputs(i, 2) = random.uniform(100e-6, 200e-6);
  cases.inputs.col(2).tail(2) << 80e-6, 220e-6;
  const auto result = cases.guard().assess(std::array{140.0, 14.0, 224.2e-6});

  EXPECT_EQ(result.verdict, Verdict::inside);
  EXPECT_THAT(result.reason,
              HasSubstr("(trained 80 to 220, 3 % of that width outside) lies no farther outside "
                        "the trained range than training cases lie outside the others'"));
}

TEST(Guard, AnUnusualCombinationOfInputsInRangeIsOutside) {
  const auto result = Cases().guard().assess(std::array{100.0, 19.0, 180e-6});

  EXPECT_EQ(result.verdict, Verdict::outside);
  EXPECT_THAT(result.out_of_range, ElementsAre());
  EXPECT_THAT(result.unusual, ElementsAre(HasSubstr("fuel 19 kg/s: 10"), HasSubstr("air 360 t/h: 68")));
  EXPECT_THAT(result.reason, HasSubstr(" kg/s is usual with these other inputs (and 1 more such)"));
  EXPECT_DOUBLE_EQ(result.p_value, 1.0 / 41);
}

TEST(Guard, AnInputOffTheLineOfTheOthersIsEdgeAndFartherOffOutside) {
  // Air is 200 load +- 2.3 (uniform in 4 either side), fuel tells the load to 0.012.
  const auto guard = Cases().guard();

  EXPECT_EQ(guard.assess(std::array{140.0, 14.0, 180e-6}).verdict, Verdict::inside);
  const auto edge = guard.assess(std::array{140 + 9.5, 14.0, 180e-6});
  EXPECT_EQ(edge.verdict, Verdict::edge) << edge.reason;
  const auto outside = guard.assess(std::array{140 + 22.0, 14.0, 180e-6});
  EXPECT_EQ(outside.verdict, Verdict::outside) << outside.reason;
  EXPECT_THAT(outside.reason,
              ::testing::MatchesRegex("fuel 14 kg/s: 15.[0-9]+ .- .*|air 583.2 t/h: 50. .- .*"));
}

TEST(Guard, AlongTheLineItIsInsideAsFarAsTheTrainingCasesGo) {
  const Cases cases;
  const auto guard = cases.guard();

  for (const double load : {0.42, 0.6, 0.8, 0.98})
    ASSERT_EQ(guard.assess(std::array{200 * load, 20 * load, 180e-6}).verdict, Verdict::inside) << load;
  EXPECT_EQ(guard.assess(std::array{300.0, 30.0, 180e-6}).verdict, Verdict::outside);
}

TEST(Guard, AnInputThatNeverChangedMayNotChange) {
  const Cases cases;

  EXPECT_EQ(cases.guard().assess(std::array{140.0, 14.0, 200e-6}).verdict, Verdict::outside);
  EXPECT_EQ(cases.guard().assess(std::array{140.0, 14.0, 180e-6 * (1 + 1e-12)}).verdict, Verdict::inside);
}

TEST(Guard, ASingleTrainingCaseKnowsOnlyItself) {
  const Guard guard(field::InputSchema({{"air", "kg/s", "kg/s"}}), MatrixD::Constant(1, 1, 5.0), {"only"},
                    {1.0});

  EXPECT_EQ(guard.assess(std::array{5.0}).verdict, Verdict::inside);
  EXPECT_EQ(guard.assess(std::array{6.0}).verdict, Verdict::outside);
}

TEST(Guard, RefusesInputsThatAreNotFinite) {
  const auto guard = Cases().guard();

  EXPECT_THROW((void)guard.assess(std::array{std::nan(""), 14.0, 180e-6}), NumericalError);
  EXPECT_THROW((void)guard.assess(std::array{140.0, std::numeric_limits<double>::infinity(), 180e-6}),
               NumericalError);
}

TEST(Guard, SaysTheSameAfterSaveAndLoad) {
  const Cases cases;
  io::TensorFile file;
  cases.guard().save(file, "guard");

  const auto loaded = Guard::load(file, "guard", cases.schema);

  for (const double air : {60.0, 140.0, 205.0, 1e6}) {
    const auto a = cases.guard().assess(std::array{air, 14.0, 180e-6}),
               b = loaded.assess(std::array{air, 14.0, 180e-6});
    EXPECT_EQ(a.verdict, b.verdict);
    EXPECT_EQ(a.reason, b.reason);
    EXPECT_EQ(a.p_value, b.p_value);
    EXPECT_EQ(a.nearest[0].name, b.nearest[0].name);
  }
}

TEST(Guard, RefusesTensorsOfAnotherSchema) {
  const Cases cases;
  io::TensorFile file;
  cases.guard().save(file, "guard");

  EXPECT_THROW((void)Guard::load(file, "guard", field::InputSchema({{"air", "kg/s", "t/h"}})), InputError);
}

}  // namespace
}  // namespace elrom::model
