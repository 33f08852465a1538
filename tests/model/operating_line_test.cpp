#include "elrom/model/operating_line.hpp"

#include <gmock/gmock.h>

#include <cmath>

#include "elrom/base/random.hpp"

namespace elrom::model {
namespace {

constexpr Eigen::Index n_plant_inputs = 8;

double normal(base::Random& random) {
  double sum = 0;
  for (int i = 0; i < 12; ++i) sum += random.uniform(-0.5, 0.5);
  return sum;
}

/// Inputs 10 (1 + k) load, each with a scatter of 5 % of its value; the last does not follow the load.
MatrixD plant(std::size_t n_cases, std::uint64_t seed) {
  base::Random random{base::Seed(seed)};
  MatrixD inputs(static_cast<Eigen::Index>(n_cases), n_plant_inputs);
  for (Eigen::Index i = 0; i < inputs.rows(); ++i) {
    const double load = random.uniform(0.4, 1.0);
    for (Eigen::Index j = 0; j + 1 < n_plant_inputs; ++j)
      inputs(i, j) = 10.0 * static_cast<double>(j + 1) * load * (1 + 0.05 * normal(random));
    inputs(i, n_plant_inputs - 1) = 300 + 20 * normal(random);
  }
  return inputs;
}

std::vector<double> at_load(double load) {
  std::vector<double> inputs;
  for (Eigen::Index j = 0; j + 1 < n_plant_inputs; ++j)
    inputs.push_back(10.0 * static_cast<double>(j + 1) * load);
  inputs.push_back(300);
  return inputs;
}

TEST(OperatingLine, FindsWhatTheOthersMakeUsualAndItsScatter) {
  const OperatingLine line(plant(2000, 1));

  for (const double load : {0.5, 0.7, 0.9}) {
    const auto usual = line.usual(at_load(load));
    // Given the others, the load is known to 5 % / sqrt(6).
    const double own = 30 * load, sigma = 0.05 * own * std::sqrt(1 + 1.0 / 6);
    EXPECT_NEAR(usual[2].value, own, 0.15 * sigma) << load;
    EXPECT_NEAR(usual[2].deviation, sigma, 0.15 * sigma) << load;
    EXPECT_NEAR(usual[7].value, 300, 1) << load;
    EXPECT_NEAR(usual[7].deviation, 20, 2) << load;
  }
}

TEST(OperatingLine, WhatIsUsualOfAnInputDoesNotHangOnItsOwnValue) {
  const OperatingLine line(plant(60, 2));
  auto inputs = at_load(0.7);
  const auto before = line.usual(inputs)[3];
  inputs[3] *= 2;

  EXPECT_NEAR(line.usual(inputs)[3].value, before.value, 1e-9 * before.value);
  EXPECT_GT(line.usual(inputs)[3].distance(inputs[3]), 5);
}

TEST(OperatingLine, AFewPerCentOfFurtherCasesLieBeyondTheLimit) {
  const OperatingLine line(plant(200, 3));
  const auto further = plant(1000, 4);
  int beyond = 0;
  for (Eigen::Index i = 0; i < further.rows(); ++i) {
    const Eigen::RowVectorXd row = further.row(i);
    const auto usual = line.usual({row.data(), static_cast<std::size_t>(row.size())});
    for (Eigen::Index j = 0; j < n_plant_inputs; ++j) {
      if (usual[static_cast<std::size_t>(j)].distance(row[j]) <= line.limit()) continue;
      ++beyond;
      break;
    }
  }
  EXPECT_GT(beyond, 5);
  EXPECT_LT(beyond, 80);
}

TEST(OperatingLine, FewCasesNeedWiderLimits) {
  EXPECT_DOUBLE_EQ(growth_for_few(20), 2);
  EXPECT_DOUBLE_EQ(growth_for_few(200), 1.01);
  const OperatingLine few(plant(20, 8)), many(plant(200, 8));
  EXPECT_NEAR(few.far_limit() / few.limit(), 3.2, 1e-12);
  EXPECT_NEAR(many.far_limit() / many.limit(), 1.616, 1e-12);
}

// Of n cases k, so that (k + 1) / (n + 1) is at most 5 %.
TEST(OperatingLine, FewCasesMayBeFlagged) {
  EXPECT_EQ(most_flagged(18), 0U);
  EXPECT_EQ(most_flagged(64), 2U);
  EXPECT_EQ(most_flagged(199), 9U);
}

TEST(OperatingLine, CasesFlaggedForOtherReasonsLeaveLessRoom) {
  const auto cases = plant(199, 9);
  EXPECT_GT(OperatingLine(cases, 9).limit(), OperatingLine(cases).limit());
}

TEST(OperatingLine, ALearnedCaseIsJudgedByTheOthersAlone) {
  auto inputs = plant(40, 5);
  const double usual = OperatingLine(inputs).left_out(7)[4].value;
  inputs(7, 4) *= 1.5;
  const auto judged = OperatingLine(inputs).left_out(7)[4];

  EXPECT_NEAR(judged.value, usual, 0.02 * usual);
  EXPECT_GT(judged.distance(inputs(7, 4)), 5);
}

TEST(OperatingLine, FewCasesOrConstantInputsKnowNothing) {
  const OperatingLine few(plant(OperatingLine::fewest_cases - 1, 6));
  EXPECT_EQ(few.usual(at_load(0.5))[0].distance(1e9), 0);

  auto inputs = plant(40, 7);
  inputs.col(2).setConstant(5);
  const auto usual = OperatingLine(inputs).usual(at_load(0.5));
  EXPECT_EQ(usual[2].distance(1e9), 0);
  EXPECT_GT(usual[1].distance(1e9), 100);
}

TEST(OperatingLine, PerfectlyCorrelatedInputsStayFinite) {
  MatrixD inputs(20, 3);
  for (Eigen::Index i = 0; i < 20; ++i) inputs.row(i).setConstant(1 + static_cast<double>(i));
  const auto usual = OperatingLine(inputs).usual(std::array{5.0, 5.0, 5.0});

  for (const auto& one : usual) {
    EXPECT_NEAR(one.value, 5, 0.1);
    EXPECT_GT(one.deviation, 0);
  }
}

TEST(OperatingLine, SaysItInTheUsersUnit) {
  const field::InputInfo temperature{"gas_temperature", "K", "degC"}, air{"air", "kg/s", "kg/s"};

  EXPECT_EQ(unusual_text(air, 225, {177.4, 10.9}),
            "air 225 kg/s: 177 +- 11 kg/s is usual with these other inputs");
  EXPECT_EQ(unusual_text(temperature, 1273.15, {1100, 3.21}),
            "gas_temperature 1000 degC: 826.9 +- 3.2 degC is usual with these other inputs");
}

}  // namespace
}  // namespace elrom::model
