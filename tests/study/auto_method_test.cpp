#include "elrom/study/auto_method.hpp"

#include <gtest/gtest.h>

#include "elrom/base/error.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/study/cross_validation.hpp"
#include "elrom/study/peers.hpp"
#include "support/throws.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::study {
namespace {

/// Predicts the truth plus a given error pattern; fits to the nearest peer, which nobody asks.
class Fake final : public Method {
 public:
  Fake(std::string name, MatrixF errors) : name_(std::move(name)), errors_(std::move(errors)) {}
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const override {
    return make_peer("nearest")->fit(data, cases, context);
  }
  [[nodiscard]] MatrixF cross_predict(const FieldData& data, const Folds&, const FitContext&) const override {
    if (errors_.size() == 0) throw NumericalError("it diverged");
    return data.values - errors_;
  }

 private:
  std::string name_;
  MatrixF errors_;
};

MatrixF noise(const FieldData& data, std::string_view name, double size) {
  base::Random random(base::Seed(41).derive(name));
  MatrixF errors(data.values.rows(), data.values.cols());
  for (Eigen::Index i = 0; i < errors.size(); ++i)
    errors.data()[i] = static_cast<float>(size * random.normal());
  return errors;
}

struct Contest {
  CaseSet cases = test::toy_cases(10);
  FieldData data = test::toy_field(cases);
  AutoFit run(const std::vector<const Method*>& candidates) {
    return fit_auto(data, math::all_rows(10), candidates, {}, {});
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

TEST(Auto, TakesTheWinnerAlone) {
  Contest contest;
  const MatrixF base = noise(contest.data, "base", 0.1);
  const Fake good("good", base), bad("bad", 3 * base);

  const AutoFit fit = contest.run({&bad, &good});

  EXPECT_EQ(fit.candidates[0].weight, 0);
  EXPECT_EQ(fit.candidates[1].weight, 1);
  EXPECT_NEAR(fit.candidates[0].nrmse, 3 * fit.candidates[1].nrmse, 1e-4 * fit.candidates[0].nrmse);
  EXPECT_EQ(fit.model->kind(), "nearest");
}

TEST(Auto, BlendsErrorsThatCancel) {
  Contest contest;
  const Fake one("one", noise(contest.data, "a", 0.1)), two("two", noise(contest.data, "b", 0.1));

  const AutoFit fit = contest.run({&one, &two});

  EXPECT_NEAR(fit.candidates[0].weight, 0.5, 0.05);
  EXPECT_NEAR(fit.nrmse, fit.candidates[0].nrmse / std::sqrt(2), 0.06 * fit.nrmse);
  EXPECT_EQ(fit.model->kind(), "blend");
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

  EXPECT_EQ(fit.candidates[0].weight, 1);
  EXPECT_EQ(fit.candidates[1].weight, 0);
  EXPECT_NEAR(fit.nrmse, fit.candidates[0].nrmse, 1e-9);
}

TEST(Auto, ACandidateThatDivergesOnlyLoses) {
  Contest contest;
  const Fake broken("broken", {}), good("good", noise(contest.data, "a", 0.1));

  const AutoFit fit = contest.run({&broken, &good});

  EXPECT_EQ(fit.candidates[0].failure, "it diverged");
  EXPECT_EQ(fit.candidates[1].weight, 1);
  EXPECT_ERROR(NumericalError, "it diverged", contest.run({&broken}));
}

TEST(Auto, ANanNeverWins) {
  Contest contest;
  MatrixF errors = MatrixF::Zero(10, contest.data.values.cols());
  errors(3, 3) = std::numeric_limits<float>::quiet_NaN();
  const Fake nan("nan", errors), good("good", noise(contest.data, "a", 0.1));

  EXPECT_EQ(contest.run({&nan, &good}).candidates[0].weight, 0);
}

}  // namespace
}  // namespace elrom::study
