#include "elrom/methods/cross_validation.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/peers.hpp"
#include "support/throws.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::methods {
namespace {

TEST(LoadGroupedFolds, HoldEveryCaseOnce) {
  std::vector<double> loads(37);
  for (std::size_t i = 0; i < loads.size(); ++i) loads[i] = static_cast<double>((i * 17) % 37);

  const Folds folds = load_grouped_folds(loads, math::all_rows(37), 5);

  std::vector<std::size_t> seen;
  for (const auto& fold : folds) {
    EXPECT_GE(fold.size(), 7U);
    EXPECT_LE(fold.size(), 8U);
    seen.insert(seen.end(), fold.begin(), fold.end());
  }
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(seen, math::all_rows(37));
}

TEST(JoinedFolds, ACaseJoinsItsNearestLoadAndTheOthersStay) {
  const double unknown = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> loads{0.1, 0.2, 0.8, 0.9, 0.22, 0.84, unknown, unknown};

  EXPECT_EQ(joined({{0, 1}, {2, 3}}, loads, std::vector<std::size_t>{4, 5}), (Folds{{0, 1, 4}, {2, 3, 5}}));
  EXPECT_EQ(joined({{0, 3}, {1, 6}}, loads, std::vector<std::size_t>{7}), (Folds{{0, 3}, {1, 6, 7}}))
      << "unknown loads are near each other";
}

TEST(JoinedFolds, OnlyAWarmStartKeepsThem) {
  const std::vector<double> loads{0.1, 0.2, 0.3, 0.4, 0.5, 0.6};
  const auto in_two = [&](std::span<const std::size_t> rows) {
    return load_grouped_folds(loads, rows, 2, 1);
  };
  const WarmStart warm{.parent = "p", .model = nullptr, .known = {0, 1, 2, 4}};

  EXPECT_EQ(folds_of(math::all_rows(6), loads, {}, in_two), (Folds{{0, 1, 2}, {3, 4, 5}}));
  EXPECT_EQ(folds_of(math::all_rows(6), loads, {.warm = &warm}, in_two), (Folds{{0, 1}, {2, 3, 4, 5}}));
}

TEST(LoadGroupedFolds, KeepNeighbouringLoadsTogether) {
  const std::vector<double> loads{0.9, 0.1, 0.2, 0.8, 0.3, 0.7, 0.4, 0.6};

  const Folds folds = load_grouped_folds(loads, math::all_rows(8), 2, 2);  // blocks of two, dealt in turn

  EXPECT_THAT(folds[0], ::testing::ElementsAre(1, 2, 5, 7));  // loads 0.1 0.2 and 0.6 0.7
  EXPECT_THAT(folds[1], ::testing::ElementsAre(0, 3, 4, 6));  // loads 0.3 0.4 and 0.8 0.9
}

TEST(LoadGroupedFolds, AreNeverMoreThanCases) {
  const std::vector<double> loads{1, 2, 3};

  EXPECT_EQ(load_grouped_folds(loads, math::all_rows(3), 10).size(), 3U);
  EXPECT_ERROR(UsageError, "at least 2", load_grouped_folds(loads, math::all_rows(1), 10));
}

TEST(SpreadFolds, TakeEveryNthLoad) {
  field::CaseSet cases = test::toy_cases(7);
  cases.loads = {0.9, 0.1, 0.2, 0.8, 0.3, 0.7, 0.4};

  const Folds folds = spread_folds(cases, math::all_rows(7), 3);

  EXPECT_THAT(folds, ::testing::ElementsAre(::testing::ElementsAre(0, 1, 6), ::testing::ElementsAre(2, 5),
                                            ::testing::ElementsAre(3, 4)));
}

TEST(SpreadFolds, KeepCasesOfEqualInputsTogether) {
  field::CaseSet cases = test::toy_cases(6);
  for (const std::size_t i : {1U, 4U}) {
    cases.loads[i] = i == 1 ? cases.loads[0] : NAN;  // of one of the repeated runs nobody wrote the load down
    cases.inputs.row(static_cast<Eigen::Index>(i)) = cases.inputs.row(0);
  }

  const Folds folds = spread_folds(cases, math::all_rows(6), 3);

  const auto holds = [](const std::vector<std::size_t>& fold, std::size_t row) {
    return std::ranges::count(fold, row) == 1;
  };
  for (const auto& fold : folds)
    EXPECT_TRUE(holds(fold, 0) == holds(fold, 1) && holds(fold, 0) == holds(fold, 4));
  EXPECT_EQ(folds[0].size() + folds[1].size() + folds[2].size(), 6U);
}

TEST(CrossPredict, NeverShowsAModelItsOwnFold) {
  const field::CaseSet cases = test::toy_cases(12);
  field::FieldData data = test::toy_field(cases);
  const Folds folds = load_grouped_folds(cases.loads, math::all_rows(12), 4);
  const auto method = make_peer("nearest");

  const MatrixF before = method->cross_predict(data, folds, {});
  for (std::size_t row : folds[2]) data.values.row(static_cast<Eigen::Index>(row)).setConstant(1e6F);
  const MatrixF after = method->cross_predict(data, folds, {});

  for (std::size_t row : folds[2]) {
    const auto i = static_cast<Eigen::Index>(row);
    EXPECT_TRUE(before.row(i) == after.row(i)) << "case " << row << " saw its own field";
  }
}

TEST(CrossPredict, LearnsFromAllOtherFoldsWhicheverAreWanted) {
  const field::CaseSet cases = test::toy_cases(12);
  const field::FieldData data = test::toy_field(cases, 0.01);
  const Folds folds = load_grouped_folds(cases.loads, math::all_rows(12), 4);

  for (const std::string name : {"linear", "pod_gp_per_mode"}) {
    const auto method = make_peer(name);
    const MatrixF all = method->cross_predict(data, folds, {});
    const MatrixF one = method->predict_folds(data, folds, std::vector<std::size_t>{2}, {.n_threads = 2});
    for (std::size_t k = 0; k < 4; ++k)
      for (const std::size_t row : folds[k]) {
        const auto i = static_cast<Eigen::Index>(row);
        EXPECT_TRUE(one.row(i) == (k == 2 ? MatrixF(all.row(i)) : MatrixF::Zero(1, all.cols()))) << name;
      }
  }
}

TEST(CrossPredict, GivesTheSameBitsForAnyNumberOfThreads) {
  const field::CaseSet cases = test::toy_cases(12);
  const field::FieldData data = test::toy_field(cases, 0.01);
  const Folds folds = load_grouped_folds(cases.loads, math::all_rows(12), 4);

  for (const std::string name : {"linear", "pod_gp", "pod_rbf"}) {
    const auto method = make_peer(name);
    EXPECT_TRUE(method->cross_predict(data, folds, {.n_threads = 1}) ==
                method->cross_predict(data, folds, {.n_threads = 3}))
        << name;
  }
}

}  // namespace
}  // namespace elrom::methods
