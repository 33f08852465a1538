#include "elrom/model/smoother_coefficients.hpp"

#include <gtest/gtest.h>

#include "elrom/base/random.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/model/pod_model.hpp"

namespace elrom::model {
namespace {

using Eigen::Index;

constexpr Index n_known = 7, n_inputs = 2, n_fitted = 3;

MatrixD random_matrix(Index rows, Index columns, std::uint64_t seed) {
  base::Random random{base::Seed(seed)};
  MatrixD values(rows, columns);
  for (auto& value : values.reshaped()) value = random.normal();
  return values;
}

SmootherKernel kernel(bool antisymmetric) {
  SmootherKernel kernel{.antisymmetric = antisymmetric, .linear = 0.3, .constant = 0.2, .noise = 0.4};
  kernel.inverse_lengths = Eigen::Vector2d(0.5, 0.8);
  kernel.imbalance = Eigen::Vector2d(1, 0.7);
  return kernel;
}

Eigen::MatrixXd covariance(const SmootherKernel& kernel, const MatrixD& z) {
  Eigen::MatrixXd k = kernel.matrix(z, z);
  k.diagonal().array() += kernel.noise;
  return k;
}

/// A smoother of these cases' coefficients, by the textbook; a symmetric one about their mean.
SmootherCoefficients smoother(const MatrixD& z, const MatrixD& coefficients, bool antisymmetric,
                              math::Covariance kind = math::Covariance::matern52) {
  MatrixD centred = coefficients;
  if (!antisymmetric) centred.rowwise() -= coefficients.colwise().mean().eval();
  auto own = kernel(antisymmetric);
  own.covariance = kind;
  const math::Cholesky factor(covariance(own, z));
  std::vector<Feature> features(2);
  for (std::int32_t i = 0; i < 2; ++i) features[static_cast<std::size_t>(i)].terms = {{.form = {{i}, {1}}}};
  return {
      FeatureMap(features, 2),
      math::Standardiser(Eigen::Vector2d::Zero(), Eigen::Vector2d::Ones()),
      z,
      {{own, factor.solve(centred), Eigen::VectorXd::Ones(n_fitted), factor.inverse_factor().cast<float>()}}};
}

Eigen::VectorXd predicted(const SmootherCoefficients& model, const Eigen::Vector2d& inputs) {
  Eigen::VectorXd coefficients(n_fitted);
  Workspace workspace;
  model.predict({inputs.data(), 2}, {coefficients.data(), n_fitted}, {}, false, workspace);
  return coefficients;
}

TEST(SmootherKernel, AnAntisymmetricOneIsOddButForItsConstant) {
  const std::array<double, 2> z{0.5, -1}, other{2, 0.3};
  const double r = std::hypot(0.75, 1.04), near = math::covariance(math::Covariance::matern52, r);
  const double product = 0.5 * 2 - 1 * 0.3 * 0.7 * 0.7;
  auto odd = kernel(true);

  EXPECT_NEAR(odd(z.data(), other.data()), (product + 0.2) * (0.3 + near), 1e-12);
  odd.constant = 0;
  EXPECT_NEAR(odd(z.data(), other.data()), product * (0.3 + near), 1e-12);
}

TEST(SmootherCoefficients, ReadsBackTheZonesOfItsGroups) {
  const MatrixD z = random_matrix(n_known, n_inputs, 1), coefficients = random_matrix(n_known, n_fitted, 2);
  const auto one = smoother(z, coefficients, false);
  auto groups = one.groups();
  groups.front().zone = 2;
  io::TensorFile file;

  SmootherCoefficients(one.features(), math::Standardiser(Eigen::VectorXd::Zero(2), Eigen::VectorXd::Ones(2)),
                       z, groups)
      .save(file, "m");

  const auto loaded = load_coefficient_model(file, "m");
  EXPECT_EQ(dynamic_cast<const SmootherCoefficients&>(*loaded).groups()[0].zone, 2U);
}

TEST(SmootherCoefficients, ReadsBackItsCovariance) {
  const MatrixD z = random_matrix(n_known, n_inputs, 1), coefficients = random_matrix(n_known, n_fitted, 2);
  for (const auto covariance : {math::Covariance::matern52, math::Covariance::gaussian}) {
    const auto model = smoother(z, coefficients, false, covariance);
    io::TensorFile file;

    model.save(file, "m");
    const auto loaded = load_coefficient_model(file, "m");

    EXPECT_EQ(dynamic_cast<const SmootherCoefficients&>(*loaded).groups()[0].kernel.covariance, covariance);
  }
}

class WithoutACase : public ::testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(OfEitherKind, WithoutACase, ::testing::Bool());

TEST_P(WithoutACase, TheSmootherIsThatOfTheOthers) {
  const MatrixD z = random_matrix(n_known, n_inputs, 1), coefficients = random_matrix(n_known, n_fitted, 2);
  const Eigen::Vector2d inputs(0.3, -0.6);
  for (Index left_out = 0; left_out < n_known; ++left_out) {
    std::vector<Index> rest;
    for (Index i = 0; i < n_known; ++i)
      if (i != left_out) rest.push_back(i);
    const MatrixD others = coefficients(rest, Eigen::all);
    const auto refitted = smoother(z(rest, Eigen::all), others, GetParam());
    Eigen::VectorXd expected = predicted(refitted, inputs);
    if (!GetParam()) expected += (others.colwise().mean() - coefficients.colwise().mean()).transpose();

    const auto reduced =
        smoother(z, coefficients, GetParam()).without_case(static_cast<std::size_t>(left_out));

    EXPECT_TRUE((predicted(*reduced.coefficients, inputs) + reduced.mean_shift).isApprox(expected, 1e-9));
    EXPECT_EQ(reduced.coefficients->n_cases(), 6u);
  }
}

TEST_P(WithoutACase, ACaseThatIsTakenOutAndPutBackChangesNothing) {
  const MatrixD z = random_matrix(n_known, n_inputs, 1), coefficients = random_matrix(n_known, n_fitted, 2);
  const auto whole = smoother(z, coefficients, GetParam());
  const Index last = n_known - 1;
  const auto reduced = whole.without_case(static_cast<std::size_t>(last));
  Eigen::VectorXd own = coefficients.row(last).transpose();
  if (!GetParam()) own -= coefficients.topRows(last).colwise().mean().transpose();

  const auto again = reduced.coefficients->with_case({z.row(last).data(), 2}, own);

  const Eigen::Vector2d inputs(0.3, -0.6);
  EXPECT_TRUE((predicted(*again.coefficients, inputs) + again.mean_shift + reduced.mean_shift)
                  .isApprox(predicted(whole, inputs), 1e-9));
}

TEST(ModelWithoutACase, MovesItsMean) {
  const MatrixD z = random_matrix(n_known, n_inputs, 1), coefficients = random_matrix(n_known, n_fitted, 2);
  MatrixF modes = MatrixF::Zero(n_fitted, 4);  // orthonormal, as modes are
  modes.diagonal() << 1, -1, 1;
  const auto whole = std::make_shared<SmootherCoefficients>(smoother(z, coefficients, false));
  const std::shared_ptr<const FieldModel> model =
      make_pod_model("kernel", Eigen::VectorXd::Constant(4, 5), modes, {}, 2, whole);
  const auto reduced = whole->without_case(2);
  const Eigen::Vector2d inputs(0.3, -0.6);
  const std::vector<std::int32_t> planes{0, 1};
  std::vector<float> values(4);
  Workspace workspace;

  const auto without = model->without_case(2);
  ASSERT_NE(without, nullptr);
  without->predict({{inputs.data(), 2}, planes}, values, {}, workspace);

  const Eigen::VectorXd expected =
      modes.cast<double>().transpose() * (predicted(*reduced.coefficients, inputs) + reduced.mean_shift);
  for (Index c = 0; c < 4; ++c) EXPECT_NEAR(values[static_cast<std::size_t>(c)], 5 + expected[c], 1e-5);

  std::vector<float> own(4), back(4);
  const Eigen::VectorXd departure =
      modes.cast<double>().transpose() * (coefficients.row(2) - coefficients.colwise().mean()).transpose();
  for (std::size_t c = 0; c < 4; ++c) own[c] = static_cast<float>(5 + departure[static_cast<Index>(c)]);
  const auto added = with_case(*without, {z.row(2).data(), 2}, own);
  ASSERT_NE(added, nullptr);
  std::vector<float> whole_values(4);
  model->predict({{inputs.data(), 2}, planes}, whole_values, {}, workspace);
  added->predict({{inputs.data(), 2}, planes}, back, {}, workspace);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(back[c], whole_values[c], 1e-4) << "taken out and put back";

  const BlendModel blend({{{0.25}, model}, {{0.75}, model}});
  const auto blended = blend.without_case(2);
  ASSERT_NE(blended, nullptr);
  std::vector<float> mixed(4);
  blended->predict({{inputs.data(), 2}, planes}, mixed, {}, workspace);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(mixed[c], values[c], 1e-5);

  // Over a scale of 3 the same cases are a third as large.
  const ScaledModel scaled(
      FeatureMap({{"scale", {{FeatureTerm::Kind::value, 1, {{}, {}, std::log(3.0)}, {}, 0}}}}, 2), model);
  const auto scaled_without = scaled.without_case(2);
  ASSERT_NE(scaled_without, nullptr);
  scaled_without->predict({{inputs.data(), 2}, planes}, mixed, {}, workspace);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(mixed[c], 3 * values[c], 1e-4);
  for (float& value : own) value *= 3;
  const auto scaled_again = with_case(*scaled_without, {z.row(2).data(), 2}, own);
  ASSERT_NE(scaled_again, nullptr);
  scaled_again->predict({{inputs.data(), 2}, planes}, mixed, {}, workspace);
  for (std::size_t c = 0; c < 4; ++c) EXPECT_NEAR(mixed[c], 3 * whole_values[c], 3e-4);
}

}  // namespace
}  // namespace elrom::model
