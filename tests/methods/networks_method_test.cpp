#include "elrom/methods/networks_method.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numeric>

#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/model/composite_models.hpp"
#include "fundamental_domain.hpp"
#include "support/random_network.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::methods {
namespace {

// Answers with a network of random weights: whatever order a prediction shows was brought in by the method.
class RandomTrainer final : public networks::Trainer {
 public:
  [[nodiscard]] std::string name() const override { return "random"; }
  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem& problem,
                                               const networks::Hyperparameters& h,
                                               const networks::TrainingBudget&, base::Seed seed,
                                               networks::TrainingMonitor*, const std::stop_token&,
                                               const std::filesystem::path&) const override {
    n_train = problem.train_inputs.rows();
    n_validation = problem.validation_inputs.rows();
    n_columns = problem.train_targets.cols();
    n_units.push_back(h.n_units);
    stopped_on.push_back(problem.validation_inputs);
    ++n_trained;
    n_gone_on += problem.start.size() > 0 ? 1 : 0;
    if (problem.start.size() > 0) start = problem.start;
    const auto n_in = static_cast<std::size_t>(problem.train_inputs.cols()),
               n_out = static_cast<std::size_t>(problem.train_targets.cols());
    networks::TrainingResult result;
    result.network = test::random_network({n_in, 7, n_out}, model::Activation::tanh, seed);
    result.validation_mse = 0.5;
    result.epochs = 1;
    return result;
  }
  // Of the last training, all on one thread.
  mutable Eigen::Index n_train = 0, n_validation = 0, n_columns = 0;
  mutable int n_trained = 0, n_gone_on = 0;
  mutable std::vector<int> n_units;
  mutable std::vector<MatrixF> stopped_on;  // inputs
  mutable MatrixF start;
};

class Networks : public ::testing::Test {
 protected:
  std::unique_ptr<model::FieldModel> fit(const std::function<void(networks::Settings&)>& change) {
    networks::Settings settings;
    settings.screen.method = "fast";
    settings.search.trials = 4;
    settings.search.confirm = 0;
    change(settings);
    std::vector<std::size_t> rows(cases.n_cases());
    std::iota(rows.begin(), rows.end(), 0);
    return NetworksMethod(settings, trainer).fit(data, rows, {});
  }
  [[nodiscard]] std::vector<float> predict(const model::FieldModel& model,
                                           std::span<const double> inputs) const {
    std::vector<float> values(cases.mesh.n_cells());
    model::Workspace workspace;
    predict_case(model, inputs, cases.mesh.n_planes, values, workspace);
    return values;
  }
  /// Largest difference between the mirror image of a prediction and the prediction for the mirror image.
  [[nodiscard]] double asymmetry(const model::FieldModel& model) const {
    const std::span<const double> inputs(cases.inputs.row(3).data(), cases.schema.size());
    const auto plain = predict(model, inputs);
    double most = 0;
    for (const auto& mirror : cases.mirrors) {
      const auto mirrored = predict(model, mirror.apply_to_inputs(inputs));
      for (std::size_t c = 0; c < plain.size(); ++c)
        most = std::max<double>(most,
                                std::abs(mirrored[c] - plain[static_cast<std::size_t>(mirror.cell_from[c])]));
    }
    return most;
  }

  field::CaseSet cases = test::toy_cases(20);
  field::FieldData data = test::toy_field(cases);
  std::shared_ptr<RandomTrainer> trainer = std::make_shared<RandomTrainer>();
};

TEST_F(Networks, TheyAreAsSymmetricAsTheFurnace) {
  EXPECT_GT(asymmetry(*fit([](auto& s) { s.networks.mirrors = false; })), 0.1)
      << "random weights know no symmetry";
  EXPECT_LT(asymmetry(*fit([](auto&) {})), 1e-4);
  EXPECT_LT(asymmetry(*fit([](auto& s) { s.networks.mirrors = false, s.networks.average = true; })), 1e-4);
}

TEST_F(Networks, OneNetworkStandsForTheColumnsOfAnOrbit) {
  (void)fit([](auto& s) { s.networks.mirrors = false; });
  EXPECT_EQ(trainer->n_columns, 24);
  (void)fit([](auto&) {});
  EXPECT_EQ(trainer->n_columns, 6);
  networks::Settings settings;
  EXPECT_EQ(NetworksMethod(settings, trainer).columns_each(data), 4U);
  settings.networks.mirrors = false;
  EXPECT_EQ(NetworksMethod(settings, trainer).columns_each(data), 1U);
}

TEST_F(Networks, ALopsidedCaseIsAnsweredLopsidedly) {
  const auto model = fit([](auto&) {});
  std::vector<double> even(cases.inputs.row(3).begin(), cases.inputs.row(3).end());
  const double air = (even[0] + even[1] + even[2] + even[3]) / 4;
  std::fill_n(even.begin(), 4, air);
  even[7] = 0.5;
  auto right = even;
  right[1] = right[3] = 1.2 * air;
  right[0] = right[2] = 0.8 * air;

  const auto plain = predict(*model, even), lopsided = predict(*model, right);

  Eigen::VectorXd found(24), expected(24);  // in the lowest plane
  for (Eigen::Index c = 0; c < 24; ++c) {
    const auto at = [&](const std::vector<double>& inputs) {
      const auto p = cases.mesh.centre.row(c);
      return test::toy_velocity(inputs, p(0), p(1), p(2));
    };
    found(c) = lopsided[static_cast<std::size_t>(c)] - plain[static_cast<std::size_t>(c)];
    expected(c) = at(right) - at(even);
  }
  EXPECT_GT(found.dot(expected), 0.9 * found.norm() * expected.norm())
      << "what the sides differ by is the kernel's, the networks here are random";
}

TEST_F(Networks, WithoutSymmetryTheyAreThoseOfTheWholeField) {
  const auto model = fit([](auto& s) {
    s.networks.average = true;
    s.symmetry.enabled = false;
  });
  EXPECT_EQ(trainer->n_columns, 24);
  EXPECT_NE(dynamic_cast<const model::BandedNetworks*>(model.get()), nullptr);
}

TEST_F(Networks, AFieldWithoutMirrorsIsLearnedWhole) {
  cases.mirrors.clear();
  const auto model = fit([](auto&) {});
  EXPECT_EQ(model->kind(), "networks");
  EXPECT_EQ(trainer->n_columns, 24);
}

TEST_F(Networks, EachBuildStopsOnCasesOfItsOwn) {
  (void)fit([](auto& s) { s.fit.builds = 5; });
  EXPECT_EQ(trainer->n_train, 16 * 8) << "the last of five";
  EXPECT_EQ(trainer->n_validation, 4 * 8);
  (void)fit([](auto& s) { s.fit.builds = 10; });
  EXPECT_EQ(trainer->n_train, 18 * 8);
  EXPECT_EQ(trainer->n_validation, 2 * 8);
}

TEST_F(Networks, TheBestBuildIsOneOfErrorsOnTheSameCases) {
  NetworkPlan plan;
  plan.bands = {{.name = "all", .columns = {0, 1, 2, 3, 4, 5}, .mask = {}}};
  plan.hyperparameters = {{{}}};
  const auto stopping_cases = [&](const std::string& combine) {
    networks::Settings settings;
    settings.fit.builds = 3;
    settings.fit.combine = combine;
    NetworksMethod method(settings, trainer);
    method.keep_plan(data.info.name, plan);
    trainer->stopped_on.clear();
    (void)method.fit(data, math::all_rows(20), {});
    return trainer->stopped_on;
  };

  const auto of_best = stopping_cases("best"), of_mean = stopping_cases("mean");

  ASSERT_EQ(of_best.size(), 3U);
  EXPECT_EQ(of_best[0], of_best[1]);
  EXPECT_EQ(of_best[0], of_best[2]);
  ASSERT_EQ(of_mean.size(), 3U);
  for (const auto& [a, b] : {std::pair(0, 1), std::pair(0, 2), std::pair(1, 2)})
    EXPECT_NE(of_mean[static_cast<std::size_t>(a)], of_mean[static_cast<std::size_t>(b)]);
}

TEST_F(Networks, BuildsTakeNearlyBestHyperparametersInTurn) {
  networks::Settings settings;
  settings.fit.builds = 5;
  NetworksMethod method(settings, trainer);
  NetworkPlan plan;
  plan.bands = {{.name = "all", .columns = {0, 1, 2, 3, 4, 5}, .mask = {}}};
  plan.hyperparameters = {{{.n_units = 11}, {.n_units = 12}}};
  method.keep_plan(data.info.name, plan);
  trainer->n_units.clear();

  (void)method.fit(data, math::all_rows(20), {});

  EXPECT_THAT(trainer->n_units, ::testing::ElementsAre(11, 12, 11, 12, 11));
}

/// Two bands at most, one build, on one thread.
networks::Settings small_settings() {
  networks::Settings settings;
  settings.screen.method = "fast";
  settings.bands.edges = {1e-9};
  settings.search.trials = 4;
  settings.search.confirm = 0;
  settings.fit.builds = 1;
  return settings;
}

const model::BandedNetworks& networks_of(const model::FieldModel& model) {
  if (const auto* unfolded = dynamic_cast<const model::UnfoldedModel*>(&model))
    return networks_of(*unfolded->model());
  if (const auto* scaled = dynamic_cast<const model::ScaledModel*>(&model))
    return networks_of(*scaled->model());
  return dynamic_cast<const model::BandedNetworks&>(model);
}

TEST_F(Networks, TheirAsymmetryInFoldsIsTheKernels) {
  const NetworksMethod method(small_settings(), trainer);
  const auto folds = load_grouped_folds(cases.loads, math::all_rows(20), 4);
  const auto kernel = make_kernel_method();
  const FoldPredictions known{kernel->key(data.info.name), kernel->cross_predict(data, folds, {})},
      other{"other", known.values};
  auto doubled = known;
  doubled.values *= 2;

  const MatrixF alone = method.cross_predict(data, folds, {}),
                told = method.cross_predict(data, folds, {.known = &known}),
                told_double = method.cross_predict(data, folds, {.known = &doubled}),
                told_other = method.cross_predict(data, folds, {.known = &other});

  EXPECT_TRUE(told.isApprox(alone, 1e-5F));
  EXPECT_EQ(told_other, alone) << "of another method";
  EXPECT_FALSE(told_double.isApprox(alone, 1e-2F)) << "it is taken from there";
  const FundamentalDomain domain(cases, data.info.parity, symmetry_classes(2));
  const auto symmetric = [&](const MatrixF& values) {
    return domain.project(values, math::all_rows(20), 0, 1);
  };
  EXPECT_TRUE(symmetric(told_double).isApprox(symmetric(alone), 1e-5F)) << "and nothing else";
  const MatrixF one_fold = method.predict_folds(data, folds, std::vector<std::size_t>{1}, {.known = &known});
  for (std::size_t row = 0; row < 20; ++row) {
    const bool asked = std::ranges::binary_search(folds[1], row);
    EXPECT_EQ(one_fold.row(static_cast<Eigen::Index>(row)).norm() > 0, asked) << row;
  }
}

TEST_F(Networks, AWarmStartGoesOnFromTheNetworkOfTheKnownCases) {
  const NetworksMethod method(small_settings(), trainer);
  const WarmStart warm{.parent = "p", .model = nullptr, .known = math::all_rows(16)};
  const auto before = method.fit(data, warm.known, {});
  EXPECT_EQ(trainer->n_gone_on, 0);

  (void)method.fit(data, math::all_rows(20), {.warm = &warm});

  EXPECT_EQ(trainer->n_gone_on, 1);
  EXPECT_EQ(trainer->start,
            networks::parameters_of(networks_of(*before).parts().submodels.front().builds.front()));
}

TEST_F(Networks, NetworksInFoldsOfAWarmStartHaveSeenNeitherFoldNorNewCases) {
  const NetworksMethod method(small_settings(), trainer);
  const WarmStart warm{.parent = "p", .model = nullptr, .known = math::all_rows(16)};
  const auto known = load_grouped_folds(cases.loads, warm.known, 4);
  const auto before = method.cross_predict(data, known, {});
  auto changed = data;
  changed.values.bottomRows(4) *= 100;  // of the new cases, which nothing may depend on

  const auto after = method.cross_predict(
      changed, joined(known, cases.loads, std::vector<std::size_t>{16, 17, 18, 19}), {.warm = &warm});

  EXPECT_EQ(trainer->n_gone_on, 0);
  // Asymmetry is learned from all cases, as the kernel is.
  const FundamentalDomain domain(cases, data.info.parity, symmetry_classes(2));
  const auto symmetric = [&](const MatrixF& rows) { return domain.project(rows, warm.known, 0, 1); };
  EXPECT_TRUE(symmetric(after).isApprox(symmetric(before), 1e-5F));
  EXPECT_GT(after.bottomRows(4).cwiseAbs().rowwise().maxCoeff().minCoeff(), 0) << "and they are predicted";
}

}  // namespace
}  // namespace elrom::methods
