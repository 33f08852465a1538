#include "symmetric_part.hpp"

#include <gtest/gtest.h>

#include "elrom/math/statistics.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::methods {
namespace {

/// Gives each cell back what it was built with, whatever it is asked.
class GivenField final : public model::FieldModel {
 public:
  GivenField(Eigen::RowVectorXf values, std::size_t n_inputs, std::size_t n_planes)
      : values_(std::move(values)), n_inputs_(n_inputs), n_planes_(n_planes) {}
  [[nodiscard]] std::string kind() const override { return "given"; }
  [[nodiscard]] std::size_t n_inputs() const override { return n_inputs_; }
  [[nodiscard]] std::size_t n_planes() const override { return n_planes_; }
  [[nodiscard]] std::size_t n_columns() const override {
    return static_cast<std::size_t>(values_.size()) / n_planes_;
  }
  void predict(const model::Query&, std::span<float> values, std::span<float>,
               model::Workspace&) const override {
    std::ranges::copy(values_, values.begin());
  }
  void save(io::TensorFile&, const std::string&) const override {}

 private:
  Eigen::RowVectorXf values_;
  std::size_t n_inputs_, n_planes_;
};

/// What a model of the whole field answers for a case when its symmetric part is known.
Eigen::RowVectorXf unfolded(const SymmetricPart& part, const field::FieldData& whole, Eigen::Index i_case) {
  const auto& cases = *whole.cases;
  const auto model = part.model(
      std::make_unique<GivenField>(part.data().values.row(i_case), cases.schema.size(), cases.mesh.n_planes));
  Eigen::RowVectorXf values(whole.values.cols());
  model::Workspace workspace;
  predict_case(*model, {cases.inputs.row(i_case).data(), cases.schema.size()}, cases.mesh.n_planes,
               {values.data(), static_cast<std::size_t>(values.size())}, workspace);
  return values;
}

/// Mean of a case and its mirror images.
Eigen::RowVectorXf mean_of_images(const field::FieldData& data, Eigen::Index i_case) {
  const auto& cases = *data.cases;
  const auto group = field::symmetry_group(cases.mirrors, cases.schema.size(), cases.mesh.n_cells());
  Eigen::RowVectorXf mean = Eigen::RowVectorXf::Zero(data.values.cols());
  for (const auto& mirror : group)
    mean += static_cast<float>(mirror.field_sign(data.info.parity)) * data.values(i_case, mirror.cell_from) /
            static_cast<float>(group.size());
  return mean;
}

TEST(SymmetricPart, IsTheMeanOfTheImagesOnAQuarterOfTheColumnsOverAScale) {
  const field::CaseSet cases = test::toy_cases(20);
  const field::FieldData data = test::toy_field(cases, 0.3);

  const SymmetricPart part(data, math::all_rows(20), {});

  EXPECT_EQ(part.orbit_size(), 4U);
  ASSERT_EQ(part.data().values.cols(), data.values.cols() / 4);
  EXPECT_EQ(part.data().cases->mesh.n_columns, cases.mesh.n_columns / 4);
  EXPECT_EQ(part.data().cases->mesh.centre.rows(), part.data().values.cols());
  for (Eigen::Index i = 0; i < 20; ++i)
    EXPECT_TRUE(unfolded(part, data, i).isApprox(mean_of_images(data, i), 1e-5F)) << i;
  const auto spread = [](const MatrixF& values) {
    const Eigen::VectorXf norms = values.rowwise().norm();
    return norms.maxCoeff() / norms.minCoeff();
  };
  EXPECT_LT(spread(part.data().values), 0.6F * spread(data.values)) << "velocities follow the gas";
}

TEST(SymmetricPart, InputsAreTheMeanOfThoseThatChangePlaces) {
  const field::CaseSet cases = test::toy_cases(20);
  const field::FieldData data = test::toy_field(cases);

  const SymmetricPart part(data, math::all_rows(20), {});

  const auto own = part.data().cases->inputs.row(3), whole = cases.inputs.row(3);
  for (Eigen::Index j = 0; j < 4; ++j) EXPECT_NEAR(own(j), whole.head(4).mean(), 1e-12);
  EXPECT_EQ(own(4), whole(4));
  EXPECT_EQ(own(5), whole(5));
  EXPECT_EQ(own(7), 0.5) << "of a split its mean with the other side's";
}

TEST(SymmetricPart, TheScaleIsThatOfTheCasesItWasGiven) {
  const field::CaseSet cases = test::toy_cases(24);
  field::FieldData data = test::toy_field(cases);
  const auto seen = math::all_rows(20);
  const SymmetricPart before(data, seen, {});
  data.values.bottomRows(4) *= 100;

  const SymmetricPart after(data, seen, {});

  EXPECT_EQ(after.data().values.topRows(20), before.data().values.topRows(20));
  EXPECT_EQ(after.data().cases->inputs, before.data().cases->inputs);
}

TEST(SymmetricPart, WhereMirrorsKeepAColumnItHasAllColumns) {
  field::CaseSet odd = test::toy_cases(20);
  odd.mesh = field::make_furnace_mesh({}, 3, 6, 8);
  odd.mirrors = {field::resolve({"front-rear", 'x', {{"*_front_*", "*_rear_*"}}, {}}, odd.schema, odd.mesh)};
  const field::FieldData data = test::toy_field(odd, 0.3);

  const SymmetricPart part(data, math::all_rows(20), {});

  EXPECT_EQ(part.orbit_size(), 1U);
  ASSERT_EQ(part.data().values.cols(), data.values.cols());
  EXPECT_TRUE(unfolded(part, data, 7).isApprox(mean_of_images(data, 7), 1e-5F));
}

TEST(SymmetricPart, WithoutMirrorsItIsTheFieldOverItsScale) {
  const field::CaseSet cases = test::toy_cases(20, false);
  const field::FieldData data = test::toy_field(cases, 0.3);

  const SymmetricPart part(data, math::all_rows(20), {});

  EXPECT_EQ(part.orbit_size(), 1U);
  EXPECT_EQ(part.data().cases->inputs, cases.inputs);
  EXPECT_TRUE(unfolded(part, data, 7).isApprox(data.values.row(7), 1e-5F));
}

}  // namespace
}  // namespace elrom::methods
