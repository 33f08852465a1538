#include "elrom/methods/networks_method.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <numeric>

#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "support/random_network.hpp"
#include "support/toy_furnace.hpp"

namespace elrom::methods {
namespace {

// Answers with a network of random weights: whatever order a prediction shows was brought in by the method.
class RandomTrainer final : public networks::Trainer {
 public:
  [[nodiscard]] std::string name() const override { return "random"; }
  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem& problem,
                                               const networks::Hyperparameters&,
                                               const networks::TrainingBudget&, base::Seed seed,
                                               networks::TrainingMonitor*, const std::stop_token&,
                                               const std::filesystem::path&) const override {
    n_train = problem.train_inputs.rows();
    n_validation = problem.validation_inputs.rows();
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
  mutable std::atomic<Eigen::Index> n_train{0}, n_validation{0};
  mutable std::atomic<int> n_trained{0}, n_gone_on{0};
  mutable MatrixF start;  // the last, on one thread
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

TEST_F(Networks, AveragedOverMirrorImagesTheyAreAsSymmetricAsTheFurnace) {
  EXPECT_GT(asymmetry(*fit([](auto& s) { s.networks.average = false; })), 0.1)
      << "random weights know no symmetry";
  EXPECT_LT(asymmetry(*fit([](auto& s) { s.networks.average = true; })), 1e-4);
}

TEST_F(Networks, MirrorImagesAreTrainedOnButDoNotStopTheTraining) {
  (void)fit([](auto& s) { s.networks.mirrors = false; });
  const auto n_train = trainer->n_train.load(), n_validation = trainer->n_validation.load();
  (void)fit([](auto& s) { s.networks.mirrors = true; });
  EXPECT_EQ(trainer->n_train, 4 * n_train);
  EXPECT_EQ(trainer->n_validation, n_validation);
}

TEST_F(Networks, WithoutSymmetryThereAreNoImages) {
  (void)fit([](auto& s) { s.networks.mirrors = false; });
  const auto n_train = trainer->n_train.load();
  const auto model = fit([](auto& s) {
    s.networks.mirrors = true;
    s.networks.average = true;
    s.symmetry.enabled = false;
  });
  EXPECT_EQ(trainer->n_train, n_train);
  EXPECT_EQ(model->kind(), "networks");
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

TEST_F(Networks, AWarmStartGoesOnFromTheNetworkOfTheKnownCases) {
  const NetworksMethod method(small_settings(), trainer);
  const WarmStart warm{.parent = "p", .model = nullptr, .known = math::all_rows(16)};
  const auto before = method.fit(data, warm.known, {});
  EXPECT_EQ(trainer->n_gone_on, 0);
  const auto& earlier = dynamic_cast<const model::BandedNetworks&>(*before);

  (void)method.fit(data, math::all_rows(20), {.warm = &warm});

  EXPECT_EQ(trainer->n_gone_on, 1);
  EXPECT_EQ(trainer->start, networks::parameters_of(earlier.parts().submodels.front().builds.front()));
}

TEST_F(Networks, CrossValidationOfAWarmStartHasSeenNeitherFoldNorNewCases) {
  const NetworksMethod method(small_settings(), trainer);
  const WarmStart warm{.parent = "p", .model = nullptr, .known = math::all_rows(16)};
  const auto known = load_grouped_folds(cases.loads, warm.known, 4);
  const auto before = method.cross_predict(data, known, {});
  auto changed = data;
  changed.values.bottomRows(4) *= 100;  // of the new cases, which nothing may depend on

  const auto after = method.cross_predict(
      changed, joined(known, cases.loads, std::vector<std::size_t>{16, 17, 18, 19}), {.warm = &warm});

  EXPECT_EQ(trainer->n_gone_on, 0);
  EXPECT_EQ(after.topRows(16), before.topRows(16));
  EXPECT_GT(after.bottomRows(4).cwiseAbs().rowwise().maxCoeff().minCoeff(), 0) << "and they are predicted";
}

}  // namespace
}  // namespace elrom::methods
