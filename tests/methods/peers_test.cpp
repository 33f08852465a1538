#include "elrom/methods/peers.hpp"

#include <gtest/gtest.h>

#include "elrom/base/error.hpp"
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
INSTANTIATE_TEST_SUITE_P(Peers, EveryPeer, ::testing::ValuesIn(peer_names()));

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

TEST(Peers, UnknownNameGetsTheNearest) {
  EXPECT_ERROR(UsageError, "did you mean 'pod_rbf'", make_peer("pod_rfb"));
}

}  // namespace
}  // namespace elrom::methods
