#include "elrom/methods/peers.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/math/gaussian_process.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "support/changed_members.hpp"
#include "support/throws.hpp"
#include "support/toy_furnace.hpp"
#include "support/unseen_error.hpp"

namespace elrom::methods {
namespace {

MatrixF predict_all(const model::FieldModel& model, const field::CaseSet& cases) {
  MatrixF values(cases.inputs.rows(), static_cast<Eigen::Index>(cases.mesh.n_cells()));
  model::Workspace workspace;
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    predict_case(model, {cases.inputs.row(i).data(), 8}, cases.mesh.n_planes,
                 {values.row(i).data(), static_cast<std::size_t>(values.cols())}, workspace);
  }
  return values;
}

class EveryPeer : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Peers, EveryPeer, ::testing::ValuesIn(closed_form_peers()));

TEST_P(EveryPeer, PredictsUnseenCasesBetterThanTheMean) {
  const field::CaseSet cases = test::toy_cases(30);

  EXPECT_LT(test::unseen_error(*make_peer(GetParam()), test::toy_field(cases)),
            GetParam() == "nearest" ? 0.8 : 0.4);
}

TEST_P(EveryPeer, AFieldThatNeverVariesStaysWhatItIs) {
  const field::CaseSet cases = test::toy_cases(5);
  field::FieldData data = test::toy_field(cases);
  data.values.setConstant(0.1F);

  const auto model = make_peer(GetParam())->fit(data, math::all_rows(5), {});

  EXPECT_TRUE(predict_all(*model, cases) == data.values);
}

TEST_P(EveryPeer, TwoCasesConstantInputsAndOneWildCellStayFinite) {
  field::CaseSet cases = test::toy_cases(2);
  cases.inputs.col(3).setConstant(7);
  field::FieldData data = test::toy_field(cases);
  data.values(1, 5) = 1e30F;

  const auto model = make_peer(GetParam())->fit(data, math::all_rows(2), {});

  EXPECT_TRUE(predict_all(*model, cases).allFinite());
}

TEST_P(EveryPeer, DuplicateCasesStayFinite) {
  field::CaseSet cases = test::toy_cases(6);
  for (Eigen::Index i = 1; i < 3; ++i) cases.inputs.row(i) = cases.inputs.row(0);

  const auto model = make_peer(GetParam())->fit(test::toy_field(cases), math::all_rows(6), {});

  EXPECT_TRUE(predict_all(*model, cases).allFinite());
}

TEST_P(EveryPeer, KeepsItsNameInTheBundle) {
  const field::CaseSet cases = test::toy_cases(6);

  EXPECT_EQ(make_peer(GetParam())->fit(test::toy_field(cases), math::all_rows(6), {})->kind(), GetParam());
}

TEST_P(EveryPeer, EveryOptionIsPartOfTheKey) {
  for (const auto& options : test::each_member_changed(PeerOptions{}))
    EXPECT_NE(make_peer(GetParam(), options)->key("pressure"), make_peer(GetParam())->key("pressure"));
}

/// Cases along one smooth curve through many modes: enough of them and no smoothing, or the field is lost.
field::FieldData smooth_field(const field::CaseSet& cases) {
  field::FieldData data = test::toy_field(cases);
  for (Eigen::Index i = 0; i < data.values.rows(); ++i) {
    const double at = static_cast<double>(i) / static_cast<double>(data.values.rows());
    for (Eigen::Index c = 0; c < data.values.cols(); ++c)
      data.values(i, c) =
          static_cast<float>(std::exp(-50 * std::pow(at - 0.01 * static_cast<double>(c % 100), 2)));
  }
  return data;
}

field::CaseSet curve(std::size_t n) {
  field::CaseSet cases = test::toy_cases(n);
  for (Eigen::Index i = 0; i < cases.inputs.rows(); ++i)
    cases.inputs.row(i).setConstant(static_cast<double>(i));
  return cases;
}

TEST(Peers, OnASmoothFieldWithoutNoiseTheyChooseModesAndHardlyAnySmoothing) {
  const field::CaseSet cases = curve(40);
  const field::FieldData data = smooth_field(cases);

  for (const char* name : {"pod_gp", "pod_gp_per_mode"})
    EXPECT_LT(test::unseen_error(*make_peer(name), data), 0.03) << name;
  EXPECT_LT(test::unseen_error(*make_peer("pod_rbf"), data), 0.13) << "which has no length scale";
}

/// A plane with waves of half a hundredth of it: by any start with noise worth the name they are noise.
TEST(Peers, StartsOfTheirProcessesFindFineStructure) {
  MatrixD x(80, 2);
  Eigen::MatrixXd y(80, 1);
  for (int i = 0; i < 80; ++i) {
    x.row(i) << 3.46 * std::fmod(0.7548776662 * i, 1.0) - 1.73,
        3.46 * std::fmod(0.5698402910 * i, 1.0) - 1.73;
    y(i, 0) = x(i, 0) + 0.005 * std::sin(3 * x(i, 0)) * std::cos(3 * x(i, 1));
  }

  const auto found = math::fit_gp(x, y,
                                  {.start_lengths = PeerOptions{}.gp_start_lengths,
                                   .start_noises = PeerOptions{}.gp_start_noises,
                                   .max_iterations = PeerOptions{}.gp_iterations});

  EXPECT_LT(found.noise_variance, 1e-7);
  EXPECT_GT(found.signal_variance, 20);
}

TEST(Peers, OnPureNoiseTheyKeepToTheMean) {
  const field::CaseSet cases = test::toy_cases(24);
  field::FieldData data = test::toy_field(cases);
  base::Random random(base::Seed(3));
  for (float& value : data.values.reshaped()) value = static_cast<float>(random.normal());

  for (const char* name : {"linear", "pod_rbf", "pod_gp", "pod_gp_per_mode"})
    EXPECT_LT(test::unseen_error(*make_peer(name), data), 1.15) << name;
}

TEST(Peers, UnknownNameGetsTheNearest) {
  EXPECT_ERROR(UsageError, "did you mean 'pod_rbf'", make_peer("pod_rfb"));
}

}  // namespace
}  // namespace elrom::methods
