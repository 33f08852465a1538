#include "elrom/methods/kernel_method.hpp"

#include <gtest/gtest.h>

#include <ranges>

#include "elrom/math/kernel.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/methods/peers.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/model/pod_model.hpp"
#include "elrom/model/smoother_coefficients.hpp"
#include "leave_one_out.hpp"
#include "shrinkage.hpp"
#include "support/changed_members.hpp"
#include "support/toy_furnace.hpp"
#include "support/unseen_error.hpp"
#include "symmetry_classes.hpp"

namespace elrom::methods {
namespace {

std::vector<float> predict(const model::FieldModel& model, const field::CaseSet& cases,
                           std::vector<double> inputs) {
  std::vector<float> values(cases.mesh.n_cells());
  model::Workspace workspace;
  predict_case(model, inputs, cases.mesh.n_planes, values, workspace);
  return values;
}

TEST(SymmetryClasses, InputsFormOrbitsAndForms) {
  const field::CaseSet cases = test::toy_cases(3);
  const auto classes = symmetry_classes(2);

  const auto orbits = input_orbits(cases);
  const model::LinearForm sum = project_input(cases, 0, classes[0]),
                          share = project_input(cases, 7, classes[0]);
  const model::LinearForm odd_share = project_input(cases, 7, classes[1]);

  ASSERT_EQ(orbits.size(), 5U);
  EXPECT_EQ(orbits[0], (std::vector<std::size_t>{0, 1, 2, 3}));
  EXPECT_EQ(sum.weights, (std::vector<double>{0.25, 0.25, 0.25, 0.25}));
  EXPECT_TRUE(share.inputs.empty());  // q and 1 - q: one half on average
  EXPECT_DOUBLE_EQ(odd_share.value(std::vector<double>{0, 0, 0, 0, 0, 0, 0, 0.6}), 0.1);
}

TEST(LeaveOneOut, ClosedFormEqualsRefits) {
  const field::CaseSet cases = test::toy_cases(8);
  const field::FieldData data = test::toy_field(cases, 0.1);
  const Eigen::MatrixXd y = data.values.cast<double>();
  const MatrixD z = math::Standardiser(cases.inputs).apply(cases.inputs);
  const Eigen::MatrixXd k = (-0.05 * (math::squared_distances(z, z))).array().exp();
  const double noise = 0.2;
  double squares = 0;
  for (std::size_t left = 0; left < 8; ++left) {
    std::vector<Eigen::Index> rest;
    for (Eigen::Index i = 0; i < 8; ++i) {
      if (i != static_cast<Eigen::Index>(left)) rest.push_back(i);
    }
    Eigen::MatrixXd part = k(rest, rest);
    part.diagonal().array() += noise;
    const Eigen::MatrixXd others = y(rest, Eigen::all);
    const Eigen::RowVectorXd row = k(static_cast<Eigen::Index>(left), rest);
    const Eigen::MatrixXd solved = math::Cholesky(part).solve(others);
    squares += (y.row(static_cast<Eigen::Index>(left)) - row * solved).squaredNorm();
  }

  EXPECT_NEAR(leave_one_out_error(k, noise, y * y.transpose()), squares, 1e-8 * squares);
}

TEST(LeaveOneOut, SlopeEqualsDifferences) {
  const MatrixD z = math::Standardiser(test::toy_cases(6).inputs).apply(test::toy_cases(6).inputs);
  const Eigen::MatrixXd k = (-0.05 * (math::squared_distances(z, z))).array().exp();
  const Eigen::MatrixXd y = z.leftCols(3), gram = y * y.transpose();
  Eigen::MatrixXd slope;
  static_cast<void>(leave_one_out_error(k, 0.3, gram, &slope));
  const double h = 1e-6;

  Eigen::MatrixXd up = k, down = k;
  up(1, 4) += h, up(4, 1) += h;
  down(1, 4) -= h, down(4, 1) -= h;
  const double difference =
      (leave_one_out_error(up, 0.3, gram) - leave_one_out_error(down, 0.3, gram)) / (2 * h);

  EXPECT_NEAR(slope(1, 4) + slope(4, 1), difference, 1e-6 * std::abs(difference) + 1e-8);
}

TEST(LeaveOneOut, AStationaryKernelFindsTheInputThatMatters) {
  base::Random random(base::Seed(5));
  MatrixD x(40, 2);
  Eigen::MatrixXd y(40, 1);
  for (Eigen::Index i = 0; i < 40; ++i) {
    x.row(i) << random.normal(), random.normal();
    y(i, 0) = std::sin(2 * x(i, 0));
  }
  const std::vector<StationaryKernel> starts{{Eigen::VectorXd::Ones(1), 0.1}};
  const Eigen::MatrixXd gram = y * y.transpose();

  const auto one = fit_stationary_kernel(x, gram, math::Covariance::gaussian, true, starts);
  const auto each = fit_stationary_kernel(x, gram, math::Covariance::gaussian, false, starts);

  EXPECT_EQ(one.lengths[0], one.lengths[1]);
  EXPECT_GT(each.lengths[1], 10 * each.lengths[0]);
  EXPECT_LT(each.error, 0.1 * one.error);
  EXPECT_LT(each.noise, 1e-4);
}

/// A smooth function of three inputs, about its mean.
struct SmoothCases {
  MatrixD x;
  Eigen::MatrixXd gram;
  SmoothCases(Eigen::Index n, std::uint64_t seed) : x(n, 3) {
    base::Random random{base::Seed(seed)};
    Eigen::MatrixXd y(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) {
      for (Eigen::Index j = 0; j < 3; ++j) x(i, j) = random.uniform(-1.7, 1.7);
      y.row(i) << std::sin(x(i, 0) + 0.5 * x(i, 1)), std::exp(0.4 * x(i, 2)) * x(i, 1);
    }
    y.rowwise() -= y.colwise().mean().eval();
    gram = y * y.transpose();
  }
  [[nodiscard]] model::SmootherKernel fit() const {
    return fit_symmetric_kernel(x, {0, 1, 2}, gram, math::Covariance::gaussian);
  }
  /// Squared, as a share of the cases'.
  [[nodiscard]] double error(const model::SmootherKernel& kernel) const {
    return leave_one_out_error(kernel.matrix(x, x), kernel.noise, gram) / gram.trace();
  }
};

TEST(LeaveOneOut, ASmoothFieldsSearchEndsInTheDeeperValley) {
  const SmoothCases cases(40, 6);

  EXPECT_LT(cases.error(cases.fit()), 1.2e-2 * 1.2e-2);  // the usual start alone ends at 1.64e-2
}

TEST(LeaveOneOut, ASmoothFieldsSearchGoesOnWhereLittleIsLeft) {
  const SmoothCases cases(60, 5);
  const auto kernel = cases.fit();
  const double found = cases.error(kernel);

  for (Eigen::Index j = 0; j < 3; ++j) {
    for (const double factor : {0.97, 1.03}) {
      auto beside = kernel;
      beside.inverse_lengths[j] *= factor;
      EXPECT_GT(cases.error(beside), 0.999 * found) << j << " " << factor;
    }
  }
}

TEST(Shrinkage, KeepsSignalAndRemovesNoise) {
  base::Random random(base::Seed(9));
  MatrixF truth(20, 1024), deviations(20, 1024);
  for (Eigen::Index i = 0; i < 20; ++i) {
    const double amplitude = random.normal();
    for (Eigen::Index c = 0; c < 1024; ++c) {
      truth(i, c) = static_cast<float>(amplitude * std::cos(static_cast<double>(c / 64) / 5));
      deviations(i, c) = truth(i, c) + static_cast<float>(0.5 * random.normal());
    }
  }
  const float before = (deviations - truth).norm();
  Shrinkage shrinkage(Box{{16, 8, 8}});

  MatrixF shrunk = deviations;
  shrinkage.learn(shrunk, truth, {}, 2);
  shrinkage.apply(deviations, 1);

  EXPECT_LT((shrunk - truth).norm(), 0.3F * before);
  EXPECT_TRUE(shrunk.isApprox(deviations, 1e-5F));  // apply() does what learn() did
}

TEST(Shrinkage, FindsTheBoxOfTheMesh) {
  EXPECT_EQ(box_of(test::toy_cases(2).mesh)->sizes, (std::array<std::size_t, 3>{8, 6, 4}));
}

TEST(KernelMethod, BeatsThePeersOnASymmetricFurnace) {
  const field::CaseSet cases = test::toy_cases(30);
  const field::FieldData data = test::toy_field(cases, 0.3);

  const double kernel = test::unseen_error(*make_kernel_method(), data);

  for (const std::string& peer : closed_form_peers())
    EXPECT_LT(kernel, test::unseen_error(*make_peer(peer), data)) << peer;
}

TEST(KernelMethod, TrustsASmoothFieldWhole) {
  const field::CaseSet cases = test::toy_cases(30);
  const field::FieldData data = test::toy_field(cases);

  const double trusted = test::unseen_error(*make_kernel_method(), data);

  // Left-out cases that were measured from another mean than their predictions were once came out 2 / (n - 1)
  // too strong.
  EXPECT_LT(trusted, 1.1 * test::unseen_error(*make_kernel_method({.shrink = false}), data));
}

/// With the noise of few cases one side is always a little above the other.
class MirroredInputs : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(OfNCases, MirroredInputs, ::testing::Values(14, 17, 20, 23, 26, 30));

TEST_P(MirroredInputs, GiveTheMirroredField) {
  const field::CaseSet cases = test::toy_cases(GetParam());
  const auto rows = math::all_rows(cases.n_cases());
  const auto model = make_kernel_method()->fit(test::toy_field(cases, 0.3), rows, {});
  const std::vector<double> inputs{5, 6, 7, 8, 60, 2e-4, 1100, 0.55};
  const field::Mirror& mirror = cases.mirrors[0];

  const auto one = predict(*model, cases, inputs),
             other = predict(*model, cases, mirror.apply_to_inputs(inputs));

  for (std::size_t c = 0; c < one.size(); ++c) {
    EXPECT_NEAR(other[c], one[static_cast<std::size_t>(mirror.cell_from[c])], 1e-4F * std::abs(one[c]));
  }
}

TEST(KernelMethod, ACaseThatIsTakenOutAndGivenBackChangesLittle) {
  const field::CaseSet cases = test::toy_cases(20);
  const field::FieldData data = test::toy_field(cases, 0.01);
  const auto model = make_kernel_method()->fit(data, math::all_rows(20), {});
  const std::vector<double> inputs(cases.inputs.row(0).begin(), cases.inputs.row(0).end());
  const std::vector<float> values(data.values.row(0).begin(), data.values.row(0).end());

  const auto without = model->without_case(0);
  ASSERT_NE(without, nullptr);
  const auto again = model::with_case(*without, inputs, values);

  const auto of = [&](const model::FieldModel& one) {
    const auto predicted = predict(one, cases, inputs);
    return Eigen::VectorXf(Eigen::VectorXf::Map(predicted.data(), std::ssize(predicted)));
  };
  EXPECT_LT((of(*again) - of(*model)).norm(), 0.5F * (of(*without) - of(*model)).norm());
}

TEST(KernelMethod, LearnsTheAsymmetryThatInputsExplain) {
  const field::CaseSet cases = test::toy_cases(40);
  const field::FieldData data = test::toy_field(cases, 0.02);

  EXPECT_LT(test::unseen_error(*make_kernel_method(), data),
            0.7 * test::unseen_error(*make_kernel_method({.antisymmetric = false}), data));
}

/// On the one side of every case the gas rises faster, whatever the inputs.
field::FieldData lopsided_field(const field::CaseSet& cases, double noise) {
  field::FieldData data = test::toy_field(cases, noise);
  for (Eigen::Index c = 0; c < data.values.cols(); ++c)
    data.values.col(c).array() += cases.mesh.centre(c, 1) < cases.mesh.centre.col(1).mean() ? 0.05F : -0.05F;
  return data;
}

TEST(KernelMethod, LearnsAnAsymmetryThatLasts) {
  const field::CaseSet cases = test::toy_cases(30);

  const double plain = test::unseen_error(*make_kernel_method(), test::toy_field(cases, 0.02)),
               lopsided = test::unseen_error(*make_kernel_method(), lopsided_field(cases, 0.02));

  EXPECT_LT(lopsided, 1.05 * plain);
}

TEST(KernelMethod, LearnsAnAsymmetryThatLastsWhereNothingIsImbalanced) {
  field::CaseSet cases = test::toy_cases(30);
  for (const auto& orbit : input_orbits(cases))
    for (const auto j : orbit)
      cases.inputs.col(static_cast<Eigen::Index>(j)) =
          cases.inputs.col(static_cast<Eigen::Index>(orbit.front())).eval();
  cases.inputs.col(7).setConstant(0.5);

  EXPECT_LT(test::unseen_error(*make_kernel_method(), lopsided_field(cases, 0.02)),
            1.05 * test::unseen_error(*make_kernel_method(), test::toy_field(cases, 0.02)));
}

TEST(KernelMethod, EveryOptionIsPartOfTheKey) {
  for (const auto& options : test::each_member_changed(KernelOptions{}))
    EXPECT_NE(make_kernel_method(options)->key("pressure"), make_kernel_method()->key("pressure"));
}

TEST(KernelMethod, ItsSymmetricPartAndItsAsymmetryAreTheWhole) {
  const field::CaseSet cases = test::toy_cases(24);
  const field::FieldData data = test::toy_field(cases, 0.1);
  const auto rows = math::all_rows(20);
  const auto fit = [&](const KernelOptions& options) {
    return make_kernel_method(options)->fit(data, rows, {});
  };
  const auto whole = fit({}), symmetric = fit({.antisymmetric = false}),
             asymmetry = fit({.symmetric = false});
  for (std::size_t i = 20; i < 24; ++i) {
    const auto row = cases.inputs.row(static_cast<Eigen::Index>(i));
    const std::vector<double> inputs(row.begin(), row.end());
    const auto all = predict(*whole, cases, inputs), one = predict(*symmetric, cases, inputs),
               other = predict(*asymmetry, cases, inputs);
    double most = 0;
    for (std::size_t c = 0; c < all.size(); ++c) {
      EXPECT_NEAR(all[c], one[c] + other[c], 1e-3 * (1 + std::abs(all[c])));
      most = std::max<double>(most, std::abs(other[c]));
    }
    EXPECT_GT(most, 0.1) << "one side's air is not the other's";
  }

  const auto folds = load_grouped_folds(cases.loads, rows, 4);
  const auto across = [&](const KernelOptions& options) {
    return make_kernel_method(options)->cross_predict(data, folds, {});
  };
  EXPECT_TRUE(across({}).topRows(20).isApprox(
      (across({.antisymmetric = false}) + across({.symmetric = false})).topRows(20), 1e-3F));
}

TEST(KernelMethod, AnAsymmetryIsNothingWithoutMirrors) {
  const field::CaseSet cases = test::toy_cases(20, false);
  const field::FieldData data = test::toy_field(cases);

  const auto model = make_kernel_method({.symmetric = false})->fit(data, math::all_rows(20), {});

  const auto row = cases.inputs.row(3);
  for (const float value : predict(*model, cases, {row.begin(), row.end()})) EXPECT_EQ(value, 0);
}

TEST(KernelMethod, AnAsymmetryThatNothingIsKnownOfIsZeroWithoutSpread) {
  const field::CaseSet cases = test::toy_cases(2);
  const field::FieldData data = test::toy_field(cases);
  const auto spread_of = [&](const KernelOptions& options) {
    const auto model = make_kernel_method(options)->fit(data, math::all_rows(2), {});
    std::vector<std::int32_t> planes(cases.mesh.n_planes);
    std::iota(planes.begin(), planes.end(), 0);
    std::vector<float> values(cases.mesh.n_cells()), spread(values.size());
    model::Workspace workspace;
    const std::span<const double> inputs(cases.inputs.row(0).data(), cases.schema.size());
    model->predict({.inputs = inputs, .planes = planes}, values, spread, workspace);
    return *std::ranges::max_element(spread);
  };

  EXPECT_EQ(spread_of({.symmetric = false}), 0);
  EXPECT_GT(spread_of({}), 0);
}

TEST(KernelMethod, WorksWithoutMirrors) {
  const field::CaseSet cases = test::toy_cases(30, false);

  EXPECT_LT(test::unseen_error(*make_kernel_method(), test::toy_field(cases)), 0.3);
}

TEST(KernelMethod, IsTheSameAfterSaveAndLoadAndForAnyThreads) {
  const field::CaseSet cases = test::toy_cases(15);
  const field::FieldData data = test::toy_field(cases, 0.1);
  const std::vector<double> inputs{5, 6, 7, 8, 60, 2e-4, 1100, 0.55};
  io::TensorFile file;

  const auto one = make_kernel_method()->fit(data, math::all_rows(15), {.n_threads = 1});
  const auto three = make_kernel_method()->fit(data, math::all_rows(15), {.n_threads = 3});
  one->save(file, "m");

  EXPECT_EQ(predict(*one, cases, inputs), predict(*three, cases, inputs));
  EXPECT_EQ(predict(*one, cases, inputs), predict(*model::load_field_model(file, "m"), cases, inputs));
}

/// What a model of the first n cases knows.
WarmStart known_of(const field::FieldData& data, std::size_t n) {
  return {"digest of a bundle", make_kernel_method()->fit(data, math::all_rows(n), {})};
}

TEST(KernelMethod, AFitThatBeginsAtAnEarlierModelIsAsGoodAsOneFromNothing) {
  const field::CaseSet cases = test::toy_cases(40);
  const field::FieldData data = test::toy_field(cases, 0.3), truth = test::toy_field(cases);
  const auto warm = known_of(data, 24);
  const auto rows = math::all_rows(30);

  const auto cold_model = make_kernel_method()->fit(data, rows, {});
  const auto warm_model = make_kernel_method()->fit(data, rows, {.warm = &warm});

  double cold_error = 0, warm_error = 0;
  for (Eigen::Index i = 30; i < 40; ++i) {
    const std::vector<double> inputs(cases.inputs.row(i).begin(), cases.inputs.row(i).end());
    const std::span<const float> exact(truth.values.row(i).data(), cases.mesh.n_cells());
    cold_error += math::squared_distance(predict(*cold_model, cases, inputs), exact);
    warm_error += math::squared_distance(predict(*warm_model, cases, inputs), exact);
  }
  EXPECT_NE(warm_error, cold_error) << "it began somewhere else";
  EXPECT_LT(std::sqrt(warm_error), 1.03 * std::sqrt(cold_error));
}

TEST(KernelMethod, FoldsOfAWarmStartErrAsModelsThatDidNotSeeThem) {
  const field::CaseSet cases = test::toy_cases(30);
  const field::FieldData data = test::toy_field(cases, 0.3);
  const auto rows = math::all_rows(30);
  const auto folds = load_grouped_folds(cases.loads, rows, 6);
  const auto warm = known_of(data, 26);

  const MatrixF cold = make_kernel_method()->cross_predict(data, folds, {});
  const MatrixF at_once = make_kernel_method()->cross_predict(data, folds, {.warm = &warm});
  const MatrixF one =
      make_kernel_method()->predict_folds(data, folds, std::vector<std::size_t>{2}, {.warm = &warm});

  const double error = (cold - data.values).norm();
  EXPECT_NEAR((at_once - data.values).norm(), error, 0.06 * error);
  EXPECT_GT((at_once - data.values).norm(), (data.values - test::toy_field(cases).values).norm())
      << "noise that nobody could have known";
  EXPECT_LT((at_once - cold).norm(), 0.3 * error);
  const auto in_fold = static_cast<Eigen::Index>(folds[2].front()),
             in_another = static_cast<Eigen::Index>(folds[3].front());
  EXPECT_TRUE(one.row(in_fold) == at_once.row(in_fold));
  EXPECT_TRUE((one.row(in_another).array() == 0).all()) << "it was not wanted";
}

TEST(KernelMethod, AnEarlierModelOfOtherFeaturesIsNoStart) {
  const field::CaseSet cases = test::toy_cases(15), plain = test::toy_cases(15, false);
  const field::FieldData data = test::toy_field(cases, 0.1);
  const auto warm = known_of(test::toy_field(plain, 0.1), 15);
  const std::vector<double> inputs{5, 6, 7, 8, 60, 2e-4, 1100, 0.55};

  const auto one = make_kernel_method()->fit(data, math::all_rows(15), {.warm = &warm}),
             other = make_kernel_method()->fit(data, math::all_rows(15), {});

  EXPECT_EQ(predict(*one, cases, inputs), predict(*other, cases, inputs));
}

/// Two inputs, the first from 0.05 to 1 and without a dimension; the field is smooth in its inverse.
struct InverseWorld {
  field::CaseSet cases;
  field::FieldData data;
  explicit InverseWorld(double noise = 0) {
    cases.mesh.n_planes = 4;
    cases.mesh.n_columns = 10;
    cases.schema = field::InputSchema({{"number", "1", "1"}, {"angle", "1", "1"}});
    cases.inputs.resize(60, 2);
    base::Random random(base::Seed(4));
    data = {&cases, {"pressure", "", "Pa"}, MatrixF(60, 40)};
    for (Eigen::Index i = 0; i < 60; ++i) {
      cases.names.push_back("case" + std::to_string(i));
      cases.loads.push_back(static_cast<double>(i));
      cases.inputs.row(i) << 1 / random.uniform(1, 20), random.uniform(-1, 1);
      for (Eigen::Index c = 0; c < 40; ++c)
        data.values(i, c) = static_cast<float>(
            std::sin(0.3 / cases.inputs(i, 0) + 0.1 * c + cases.inputs(i, 1)) + noise * random.normal());
    }
  }
};

const model::SmootherCoefficients& smoother_of(const model::FieldModel& model) {
  if (const auto* scaled = dynamic_cast<const model::ScaledModel*>(&model))
    return smoother_of(*scaled->model());
  const auto& modes = dynamic_cast<const model::PodModel&>(model);
  return dynamic_cast<const model::SmootherCoefficients&>(modes.coefficients());
}

TEST(KernelMethod, FindsTheFormOfAnInputInWhichTheFieldIsSmooth) {
  const InverseWorld world;

  const auto model = make_kernel_method()->fit(world.data, math::all_rows(60), {});

  EXPECT_EQ(smoother_of(*model).features().features()[0].name, "number, inverse");
  EXPECT_LT(test::unseen_error(*make_kernel_method(), world.data), 0.02);
}

TEST(KernelMethod, ASmoothFieldGetsASmoothCovariance) {
  const InverseWorld world;

  const auto model = make_kernel_method()->fit(world.data, math::all_rows(60), {});

  EXPECT_EQ(smoother_of(*model).groups()[0].kernel.covariance, math::Covariance::gaussian);
  EXPECT_LT(smoother_of(*model).groups()[0].kernel.noise, 1e-4);
}

/// One strong mode that hardly has noise, and weak ones that are nearly all noise.
field::FieldData strong_and_weak(const field::CaseSet& cases) {
  field::FieldData data{&cases, {"pressure", "", "Pa"}, MatrixF(60, 40)};
  base::Random random(base::Seed(9));
  for (Eigen::Index i = 0; i < 60; ++i) {
    for (Eigen::Index c = 0; c < 40; ++c)
      data.values(i, c) =
          static_cast<float>(10 * std::sin(2 * cases.inputs(i, 1)) +
                             0.5 * std::cos(0.1 * c + 5 * cases.inputs(i, 1)) + 3 * random.normal());
  }
  return data;
}

TEST(KernelMethod, LeadingModesHaveANoiseOfTheirOwn) {
  const InverseWorld world;
  const field::FieldData data = strong_and_weak(world.cases);

  const double common = test::unseen_error(*make_kernel_method({.own_modes = 0}), data);

  EXPECT_LT(test::unseen_error(*make_kernel_method(), data), common);
}

/// Waves that one input drives at the bottom and another at the top, with noise.
field::FieldData two_heights(const field::CaseSet& cases) {
  field::FieldData data{&cases, field::field_info("gas_velocity_z"), {}};
  base::Random random(base::Seed(7));
  const auto n_cells = static_cast<Eigen::Index>(cases.mesh.n_cells());
  data.values.resize(cases.inputs.rows(), n_cells);
  for (Eigen::Index i = 0; i < cases.inputs.rows(); ++i) {
    const double d50 = (cases.inputs(i, 5) - 2e-4) / 2e-5, temperature = (cases.inputs(i, 6) - 1100) / 30;
    for (Eigen::Index c = 0; c < n_cells; ++c)
      data.values(i, c) = static_cast<float>(
          std::sin(1.5 * (cases.mesh.centre(c, 2) < 11.75 ? d50 : temperature)) + 0.05 * random.normal());
  }
  return data;
}

TEST(KernelMethod, WhatMattersAtTheBottomNeedNotMatterAtTheTop) {
  const field::CaseSet cases = test::toy_cases(60, false);
  const field::FieldData data = two_heights(cases);

  const double everywhere = test::unseen_error(*make_kernel_method({.own_modes = 0, .zones = 1}), data);

  EXPECT_LT(test::unseen_error(*make_kernel_method({.own_modes = 0}), data), 0.95 * everywhere);
}

TEST(KernelMethod, AnEarlierModelStartsEachZoneAtItsOwn) {
  const field::CaseSet cases = test::toy_cases(40, false);
  const field::FieldData data = two_heights(cases);
  const auto warm = known_of(data, 40);

  const auto again =
      make_kernel_method({.own_modes = 0, .passes = 1})->fit(data, math::all_rows(40), {.warm = &warm});

  const auto& earlier = smoother_of(*warm.model).groups();
  const auto& groups = smoother_of(*again).groups();
  ASSERT_EQ(groups.size(), 3U);
  for (std::size_t zone = 0; zone < 3; ++zone) {
    EXPECT_EQ(groups[zone].zone, zone);
    const auto own =
        std::ranges::find(std::views::reverse(earlier), zone, &model::SmootherCoefficients::Group::zone);
    EXPECT_EQ(groups[zone].kernel.inverse_lengths, own->kernel.inverse_lengths);
  }
}

TEST(KernelMethod, AFieldThatVariesOnlyAtTheBottomIsPredictedThereAndConstantAbove) {
  const field::CaseSet cases = test::toy_cases(20);
  field::FieldData data = test::toy_field(cases);
  const auto n_above = 3 * static_cast<Eigen::Index>(cases.mesh.n_columns);
  data.values.rightCols(n_above).setConstant(0.5F);

  const auto model = make_kernel_method()->fit(data, math::all_rows(20), {});

  const std::vector<double> inputs(cases.inputs.row(7).begin(), cases.inputs.row(7).end());
  const auto values = predict(*model, cases, inputs);
  const Eigen::Map<const Eigen::RowVectorXf> found(values.data(), data.values.cols());
  EXPECT_TRUE(found.isApprox(data.values.row(7), 0.02F));
  EXPECT_TRUE(found.rightCols(n_above).isConstant(0.5F, 1e-4F));
}

/// A field whose shape follows the temperature, and its magnitude the square of the diameter.
field::FieldData field_by_diameter(const field::CaseSet& cases) {
  field::FieldData data{&cases, field::field_info("pressure"), {}};
  base::Random random(base::Seed(31));
  data.values.resize(cases.inputs.rows(), static_cast<Eigen::Index>(cases.mesh.n_cells()));
  for (Eigen::Index i = 0; i < data.values.rows(); ++i) {
    const double magnitude = std::pow(cases.inputs(i, 5) / 2e-4, 2),
                 warmth = (cases.inputs(i, 6) - 1100) / 30;
    for (Eigen::Index c = 0; c < data.values.cols(); ++c) {
      const double height = cases.mesh.centre(c, 2) / 20;
      data.values(i, c) = static_cast<float>(
          magnitude * (2 + std::cos(height) + std::sin(warmth + height) + 0.1 * random.normal()));
    }
  }
  return data;
}

TEST(KernelMethod, AFieldIsLearnedOverWhatItsMagnitudeFollows) {
  const field::CaseSet cases = test::toy_cases(30);
  const field::FieldData data = field_by_diameter(cases);
  KernelOptions unscaled;
  unscaled.scale = false;

  const auto model = make_kernel_method()->fit(data, math::all_rows(30), {});

  const auto* scaled = dynamic_cast<const model::ScaledModel*>(model.get());
  ASSERT_NE(scaled, nullptr);
  const auto& terms = scaled->logarithm().features().front().terms;
  ASSERT_EQ(terms.size(), 3U);  // all gas, diameter, temperature
  EXPECT_NEAR(terms[1].coefficient, 2, 0.1);
  EXPECT_NEAR(terms[0].coefficient, 0, 0.1);
  EXPECT_LT(test::unseen_error(*make_kernel_method(), data),
            0.98 * test::unseen_error(*make_kernel_method(unscaled), data));
}

/// A field whose magnitude follows nothing that the inputs say.
field::FieldData field_by_chance(const field::CaseSet& cases, std::uint64_t seed) {
  field::FieldData data = field_by_diameter(cases);
  base::Random random{base::Seed(seed)};
  for (Eigen::Index i = 0; i < data.values.rows(); ++i)
    data.values.row(i).array() = static_cast<float>(3 + random.normal());
  return data;
}

/// The largest exponent of the scale that a field is learned over, 0: it has none.
double largest_exponent(const model::FieldModel& model) {
  const auto* scaled = dynamic_cast<const model::ScaledModel*>(&model);
  double largest = 0;
  if (scaled != nullptr)
    for (const auto& term : scaled->logarithm().features().front().terms)
      largest = std::max(largest, std::abs(term.coefficient));
  return largest;
}

TEST(KernelMethod, AFieldWhoseMagnitudeFollowsNothingLosesLittleByAScale) {
  const field::CaseSet cases = test::toy_cases(30);
  KernelOptions unscaled;
  unscaled.scale = false;
  double with_scale = 0, without = 0;
  for (std::uint64_t seed = 32; seed < 52; ++seed) {  // some of them take one by chance
    const auto data = field_by_chance(cases, seed);
    with_scale += test::unseen_error(*make_kernel_method(), data);
    without += test::unseen_error(*make_kernel_method(unscaled), data);
  }
  EXPECT_LT(with_scale, 1.15 * without);
}

TEST(KernelMethod, AnEarlierModelsScaleIsNotKeptWhereNothingFollowsIt) {
  const field::CaseSet cases = test::toy_cases(30);
  const auto warm = known_of(field_by_diameter(cases), 30);
  ASSERT_GT(largest_exponent(*warm.model), 1.9);

  const auto data = field_by_chance(cases, 32);
  const auto model = make_kernel_method()->fit(data, math::all_rows(30), {.warm = &warm});

  EXPECT_EQ(largest_exponent(*model),
            largest_exponent(*make_kernel_method()->fit(data, math::all_rows(30), {})));
}

TEST(KernelMethod, HardCasesStayFinite) {
  field::CaseSet cases = test::toy_cases(6);
  field::FieldData data = test::toy_field(cases);
  const std::vector<double> far{0, 1e9, -1, 0, 1e-12, 10, 5, 3};
  const auto rows = math::all_rows(6);

  data.values(2, 7) = 1e30F;
  auto values = predict(*make_kernel_method()->fit(data, rows, {}), cases, far);
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }))
      << "one wild cell";

  data.values.setZero();
  values = predict(*make_kernel_method()->fit(data, rows, {}), cases, far);
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float v) { return v == 0; }))
      << "a field of zeros";

  cases.inputs.rowwise() = Eigen::RowVectorXd(cases.inputs.row(0));
  values = predict(*make_kernel_method()->fit(test::toy_field(cases, 0.1), rows, {}), cases, far);
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }))
      << "inputs that never vary";
}

}  // namespace
}  // namespace elrom::methods
