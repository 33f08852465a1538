#include "elrom/methods/auto_method.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/methods/peers.hpp"
#include "support/fake_method.hpp"
#include "support/throws.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::methods {
namespace {

using test::lopsided;
using test::noise;
using Fake = test::FakeMethod;

struct Contest {
  field::CaseSet cases = test::toy_cases(10);
  field::FieldData data = test::toy_field(cases);
  AutoFit run(const std::vector<const Method*>& candidates, const AutoOptions& options = {}) {
    return fit_auto(data, math::all_rows(10), candidates, options, {});
  }
};

TEST(BlendWeights, OfIndependentErrorsGoWithInverseVariance) {
  const Eigen::MatrixXd gram = Eigen::Vector2d(1, 4).asDiagonal();

  const auto weights = blend_weights(gram);

  EXPECT_NEAR(weights[0], 0.8, 1e-9);
  EXPECT_NEAR(weights[1], 0.2, 1e-9);
}

TEST(BlendWeights, AreNeverNegative) {
  Eigen::MatrixXd gram(2, 2);
  gram << 1, 1.5, 1.5, 4;  // the unconstrained optimum is (1.25, -0.25)

  EXPECT_EQ(blend_weights(gram), (std::vector<double>{1, 0}));
}

/// The least w^T G w over weights of a hundredth's grid with sum 1.
double least_on_a_grid(const Eigen::Matrix3d& gram) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 100; ++i)
    for (int j = 0; i + j <= 100; ++j) {
      const Eigen::Vector3d w = Eigen::Vector3d(i, j, 100 - i - j) / 100;
      least = std::min(least, w.dot(gram * w));
    }
  return least;
}

TEST(BlendWeights, AreTheBestOfAllSetsOfMembers) {
  base::Random random(base::Seed(5));
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::Matrix3d errors;
    for (double& value : errors.reshaped()) value = random.normal();
    const Eigen::Matrix3d gram = errors * errors.transpose();
    const auto weights = blend_weights(gram);
    const Eigen::Vector3d w = Eigen::Vector3d::Map(weights.data());

    EXPECT_NEAR(w.sum(), 1, 1e-9);
    EXPECT_GE(w.minCoeff(), 0);
    EXPECT_LE(w.dot(gram * w), least_on_a_grid(gram) + 1e-9);
  }
}

TEST(Auto, GoesTowardsABlendAsFarAsItGains) {
  // Equal, independent errors: the blend gains 1 - 1 / sqrt(2). Asked for three times that, it has a third.
  Contest contest;
  const Fake one("one", noise(contest.data, "a", 0.1)), two("two", noise(contest.data, "b", 0.1));
  const double gain = 1 - std::sqrt(0.5);

  const AutoFit fit = contest.run({&one, &two}, {.full_gain = 3 * gain});

  const double less = std::min(fit.candidates[0].mean_weight(), fit.candidates[1].mean_weight());
  EXPECT_NEAR(less, 0.5 / 3, 0.03);
  EXPECT_NEAR(fit.nrmse, fit.candidates[0].nrmse * std::hypot(less, 1 - less), 0.08 * fit.nrmse);
}

TEST(Auto, AMemberOfNextToNoWeightIsLeftOut) {
  Contest contest;
  const Fake one("one", noise(contest.data, "a", 0.1)), two("two", noise(contest.data, "b", 0.1));

  const AutoFit fit = contest.run({&one, &two}, {.full_gain = 3});  // a tenth of the way: 0.05

  EXPECT_EQ(std::max(fit.candidates[0].mean_weight(), fit.candidates[1].mean_weight()), 1);
}

TEST(Auto, TakesTheWinnerAlone) {
  Contest contest;
  const MatrixF base = noise(contest.data, "base", 0.1);
  const Fake good("good", base), bad("bad", 3 * base);

  const AutoFit fit = contest.run({&bad, &good});

  EXPECT_EQ(fit.candidates[0].mean_weight(), 0);
  EXPECT_EQ(fit.candidates[1].mean_weight(), 1);
  EXPECT_NEAR(fit.candidates[0].nrmse, 3 * fit.candidates[1].nrmse, 1e-4 * fit.candidates[0].nrmse);
  EXPECT_EQ(fit.model->kind(), "nearest");
}

TEST(Auto, BlendsErrorsThatCancel) {
  Contest contest;
  const Fake one("one", noise(contest.data, "a", 0.1)), two("two", noise(contest.data, "b", 0.1));

  const AutoFit fit = contest.run({&one, &two});

  EXPECT_NEAR(fit.candidates[0].mean_weight(), 0.5, 0.05);
  EXPECT_NEAR(fit.nrmse, fit.candidates[0].nrmse / std::sqrt(2), 0.06 * fit.nrmse);
  EXPECT_EQ(fit.model->kind(), "blend");
}

TEST(Auto, TheBestAloneIsJudgedByOtherFoldsAsABlendIs) {
  // Without case 0 "one" is best, and far off there; by all cases another one is. Judged by its own choice
  // the latter would seem better than any blend, which those of case 0 let err with "one".
  Contest contest;
  MatrixF errors = noise(contest.data, "a", 0.1);
  errors.row(0) *= 10;
  const Fake one("one", errors), two("two", noise(contest.data, "b", 0.15)),
      three("three", noise(contest.data, "c", 0.15));

  const AutoFit fit = contest.run({&one, &two, &three});

  EXPECT_EQ(fit.candidates[0].mean_weight(), 0);
  EXPECT_NEAR(fit.candidates[1].mean_weight(), 0.5, 0.1);
}

TEST(Auto, DoesNotBlendForTheSakeOfOneCase) {
  // "two" cancels the error of "one" in case 0, where both are far off, and is worse in all the others:
  // weights fitted to all cases would gain a third, weights learned without case 0 do not see it.
  Contest contest;
  MatrixF one = noise(contest.data, "a", 0.1), two = noise(contest.data, "b", 0.5);
  two.row(0) = -10 * one.row(0);
  one.row(0) *= 10;
  const Fake first("one", one), second("two", two);

  const AutoFit fit = contest.run({&first, &second});

  EXPECT_EQ(fit.candidates[0].mean_weight(), 1);
  EXPECT_EQ(fit.candidates[1].mean_weight(), 0);
  EXPECT_NEAR(fit.nrmse, fit.candidates[0].nrmse, 1e-9);
}

TEST(Auto, WeighsBandsByThemselvesWhereThatPays) {
  // Each is right in its own half; "right" is better on the
  // whole, and its error sorts columns into two bands.
  Contest contest;
  const Fake left("left", 1.1F * lopsided(contest.data, "a", 0.1F)),
      right("right", lopsided(contest.data, "b", 10));

  const AutoFit fit = contest.run({&left, &right});

  const std::size_t n = contest.cases.mesh.n_columns;
  ASSERT_EQ(fit.candidates[0].weights.size(), n);
  EXPECT_EQ(fit.candidates[0].weights.front(), 1);
  EXPECT_EQ(fit.candidates[0].weights.back(), 0);
  EXPECT_EQ(fit.candidates[1].weights.front(), 0);
  EXPECT_EQ(fit.candidates[1].weights.back(), 1);
  EXPECT_EQ(fit.candidates[0].mean_weight(), 0.5);
  EXPECT_LT(fit.nrmse, 0.1 * fit.candidates[1].nrmse);
  EXPECT_EQ(fit.nrmse, fit.nrmse_by_band);
  EXPECT_EQ(fit.model->kind(), "blend");
}

TEST(Auto, WeighsAllColumnsAlikeWhereBandsGainNothing) {
  // Two bands by the error of both, and the same winner in each.
  Contest contest;
  const MatrixF base = lopsided(contest.data, "a", 10);
  const Fake good("good", base), bad("bad", 3 * base);

  const AutoFit fit = contest.run({&bad, &good});

  EXPECT_TRUE(std::isfinite(fit.nrmse_by_band));
  EXPECT_EQ(fit.candidates[1].weights.size(), 1U);
  EXPECT_EQ(fit.model->kind(), "nearest");
}

TEST(Auto, ColumnsThatAllGetRightAskForNoFurtherMembers) {
  Contest contest;
  const auto n_columns = static_cast<Eigen::Index>(contest.cases.mesh.n_columns);
  MatrixF left = 1.1F * lopsided(contest.data, "a", 0.1F), right = lopsided(contest.data, "b", 10),
          third = 100 * left;
  for (Eigen::Index c = 0; c < left.cols(); c += n_columns)  // column 0: a band by itself
    for (MatrixF* errors : {&left, &right, &third}) errors->col(c).setZero();
  const Fake a("left", left), b("right", right), c("third", third);

  const AutoFit fit = contest.run({&a, &b, &c}, {.band_edges = {1e-9, 0.3}});

  EXPECT_GT(fit.candidates[0].weights.size(), 1U);
  EXPECT_EQ(fit.candidates[2].mean_weight(), 0);
}

/// Sixty cases in six folds, so that one fold is too few to judge by and three are enough.
struct Race {
  field::CaseSet cases = test::toy_cases(60);
  field::FieldData data = test::toy_field(cases);
  MatrixF errors = noise(data, "good", 0.1);
  AutoFit against(const MatrixF& other) {
    const Fake good("good", errors), late("late", other);
    return fit_auto(data, math::all_rows(60), std::vector<const Method*>{&good, &late}, {.n_folds = 6}, {});
  }
};

TEST(AutoRace, WhatCannotGainLeavesAfterSomeFolds) {
  // Errors of the good one and independent ones beside them: no weight but none lowers the sum.
  Race race;

  const AutoFit fit = race.against(race.errors + noise(race.data, "more", 0.3));

  EXPECT_EQ(fit.candidates[0].left_after, 0U);
  EXPECT_EQ(fit.candidates[1].left_after, 3U);
  EXPECT_EQ(fit.candidates[1].mean_weight(), 0);
  EXPECT_NEAR(fit.candidates[1].nrmse, std::sqrt(10.0) * fit.candidates[0].nrmse,
              0.05 * fit.candidates[1].nrmse);
}

TEST(AutoRace, NoMoreDoesWhatIsButALittleWorse) {
  // A gain would be far below the one from which a blend is taken, by chance or not.
  Race race;

  EXPECT_EQ(race.against(race.errors + noise(race.data, "more", 0.002)).candidates[1].left_after, 3U);
}

TEST(AutoRace, WhatMayGainStays) {
  Race race;
  const auto equal = race.against(noise(race.data, "other", 0.1)),
             worse = race.against(noise(race.data, "other", 0.2)), better = race.against(0.5F * race.errors);

  EXPECT_EQ(equal.candidates[1].left_after, 0U);
  EXPECT_NEAR(equal.candidates[1].mean_weight(), 0.5, 0.05);
  EXPECT_EQ(worse.candidates[1].left_after, 0U);
  EXPECT_NEAR(worse.candidates[1].mean_weight(), 0.2, 0.05);
  EXPECT_EQ(better.candidates[1].mean_weight(), 1);
}

TEST(AutoRace, WhatGainsInSomeColumnsStays) {
  // Worse on the whole, and the better one in columns where the first is far off: a band of their own.
  Race race;
  const MatrixF late = race.errors + 8 * lopsided(race.data, "more", 0.02F);
  race.errors = lopsided(race.data, "first", 8) + 0.01F * race.errors;

  const AutoFit fit = race.against(late);

  EXPECT_EQ(fit.candidates[1].left_after, 0U);
}

TEST(AutoRace, FewCasesAreNoReasonToLeave) {
  Contest contest;
  const MatrixF errors = noise(contest.data, "good", 0.1);
  const Fake good("good", errors), bad("bad", errors + noise(contest.data, "more", 0.3));

  EXPECT_EQ(contest.run({&good, &bad}).candidates[1].left_after, 0U);
}

TEST(Auto, ACandidateThatDivergesOnlyLoses) {
  Contest contest;
  const Fake broken("broken", {}), good("good", noise(contest.data, "a", 0.1));

  const AutoFit fit = contest.run({&broken, &good});

  EXPECT_EQ(fit.candidates[0].failure, "it diverged");
  EXPECT_EQ(fit.candidates[1].mean_weight(), 1);
  EXPECT_ERROR(NumericalError, "it diverged", contest.run({&broken}));
}

TEST(Auto, LaterCandidatesAreToldWhatTheFirstOneSaidOfTheFolds) {
  Contest contest;
  const MatrixF errors = noise(contest.data, "first", 0.1);
  const Fake broken("broken", {}), first("first", errors), second("second", noise(contest.data, "a", 0.1)),
      third("third", noise(contest.data, "b", 0.1));

  (void)contest.run({&broken, &first, &second, &third});

  EXPECT_FALSE(first.known.has_value());
  ASSERT_TRUE(second.known.has_value());
  EXPECT_EQ(second.known->key, first.key(contest.data.info.name));
  EXPECT_TRUE(second.known->values.isApprox(contest.data.values - errors));
  ASSERT_TRUE(third.known.has_value());
  EXPECT_EQ(third.known->key, second.known->key);
}

TEST(Auto, ANanNeverWins) {
  Contest contest;
  MatrixF errors = MatrixF::Zero(10, contest.data.values.cols());
  errors(3, 3) = std::numeric_limits<float>::quiet_NaN();
  const Fake nan("nan", errors), good("good", noise(contest.data, "a", 0.1));

  EXPECT_EQ(contest.run({&nan, &good}).candidates[0].mean_weight(), 0);
}

}  // namespace
}  // namespace elrom::methods
