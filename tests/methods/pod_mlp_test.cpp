#include "elrom/methods/pod_mlp.hpp"

#include <gmock/gmock.h>

#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/math/ridge.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/pod_model.hpp"
#include "support/changed_members.hpp"
#include "support/recording_log.hpp"

namespace elrom::methods {
namespace {

// "Trains" in closed form: a network without hidden layers, by
// ridge. Enough to see what the method does with it.
class RidgeTrainer final : public networks::Trainer {
 public:
  explicit RidgeTrainer(int n_diverging = 0) : n_diverging_(n_diverging) {}
  [[nodiscard]] std::string name() const override { return "ridge"; }
  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem& problem,
                                               const networks::Hyperparameters&,
                                               const networks::TrainingBudget&, base::Seed,
                                               networks::TrainingMonitor*, const std::stop_token&,
                                               const std::filesystem::path&) const override {
    const int call = n_calls++;
    n_train.push_back(problem.train_inputs.rows());
    if (call < n_diverging_) return {.diverged = true};
    const std::vector<double> penalty{1e-6};
    const auto ridge =
        math::fit_ridge(problem.train_inputs.cast<double>(), problem.train_targets.cast<double>(), penalty);
    const MatrixF weights = ridge.weights.transpose().cast<float>();
    const Eigen::VectorXf bias = ridge.intercept.cast<float>();
    const auto n_out = static_cast<std::size_t>(bias.size());
    model::Layer layer{io::Tensor::copy(weights),
                       io::Tensor::copy(std::span<const float>(bias.data(), n_out), {n_out})};
    return {.network = model::Network({layer}, model::Activation::relu), .validation_mse = 0.5 - 0.01 * call};
  }
  mutable int n_calls = 0;
  mutable std::vector<Eigen::Index> n_train;

 private:
  int n_diverging_;
};

PodMlpOptions one_recipe(PodMlpOptions options) {
  options.recipes.resize(1);
  return options;
}

// Fields that are linear in three inputs: the method must then be exact, whatever its scaling.
struct LinearField {
  field::CaseSet cases;
  field::FieldData data;
  explicit LinearField(std::size_t n_cases = 30) {
    cases.mesh.n_planes = 4;
    cases.mesh.n_columns = 5;
    cases.schema = field::InputSchema({{"a", "1", "1"}, {"b", "1", "1"}, {"c", "1", "1"}});
    cases.inputs.resize(static_cast<Eigen::Index>(n_cases), 3);
    base::Random random(base::Seed(1));
    const MatrixD slopes = MatrixD::NullaryExpr(3, 20, [&] { return random.normal(); });
    for (std::size_t i = 0; i < n_cases; ++i) {
      cases.names.push_back("case" + std::to_string(i));
      cases.loads.push_back(static_cast<double>(i) / static_cast<double>(n_cases));
      for (int k = 0; k < 3; ++k) cases.inputs(static_cast<Eigen::Index>(i), k) = 100 + 10 * random.normal();
    }
    data.cases = &cases;
    data.info = {"pressure", "", "Pa"};
    data.values = ((cases.inputs * slopes).array() + 1e3).matrix().cast<float>();
  }
  [[nodiscard]] std::vector<std::size_t> rows(std::size_t n) const {
    std::vector<std::size_t> rows(n);
    std::iota(rows.begin(), rows.end(), 0);
    return rows;
  }
};

TEST(PodMlp, IsExactWhereTheFieldIsLinear) {
  const LinearField field;
  const auto trainer = std::make_shared<RidgeTrainer>();
  for (const double equalise : {0.0, 0.5, 1.0}) {
    const auto method = make_pod_mlp(trainer, one_recipe({.most_modes = 3, .equalise = equalise}));

    const auto model = method->fit(field.data, field.rows(25), {});

    std::vector<float> predicted(20);
    model::Workspace workspace;
    predict_case(*model, {field.cases.inputs.row(28).data(), 3}, 4, predicted, workspace);
    const float scale = field.data.values.row(28).norm();
    for (Eigen::Index c = 0; c < 20; ++c)
      EXPECT_NEAR(predicted[static_cast<std::size_t>(c)], field.data.values(28, c), 1e-4F * scale);
  }
}

TEST(PodMlp, EveryBuildStopsOnAnotherFold) {
  const LinearField field;
  const auto trainer = std::make_shared<RidgeTrainer>();

  (void)make_pod_mlp(trainer, one_recipe({.most_modes = 3, .builds = 5}))
      ->fit(field.data, field.rows(25), {});

  EXPECT_THAT(trainer->n_train, ::testing::ElementsAre(20, 20, 20, 20, 20));
}

TEST(PodMlp, ARetrainingTakesTheRecipeOfTheEarlierModel) {
  const LinearField field;
  const auto first =
      make_pod_mlp(std::make_shared<RidgeTrainer>(), {.most_modes = 3})->fit(field.data, field.rows(20), {});
  io::TensorFile file;
  first->save(file, "model");
  const WarmStart warm{.parent = "digest", .model = model::load_field_model(file, "model")};
  ASSERT_NE(warm.mlp(), nullptr);
  EXPECT_FALSE(warm.mlp()->parts().recipe.empty());
  const auto n_trainings = [&](const FitContext& context) {
    const auto trainer = std::make_shared<RidgeTrainer>();
    (void)make_pod_mlp(trainer, {.most_modes = 3, .builds = 4})->fit(field.data, field.rows(25), context);
    return trainer->n_train.size();
  };

  EXPECT_EQ(n_trainings({.warm = &warm}), 4u);
  EXPECT_EQ(n_trainings({}), 8u);
}

TEST(PodMlp, ReadsBackWhatItSaved) {
  const LinearField field;
  const auto model = make_pod_mlp(std::make_shared<RidgeTrainer>(), one_recipe({.most_modes = 3}))
                         ->fit(field.data, field.rows(25), {});
  io::TensorFile file;

  model->save(file, "model/pressure");
  const auto loaded = model::load_field_model(file, "model/pressure");

  EXPECT_EQ(loaded->kind(), "pod_mlp");
  model::Workspace workspace;
  const std::vector<std::int32_t> planes{0, 2};
  std::vector<float> before(10), after(10), spread_before(10), spread_after(10);
  for (const bool best : {false, true}) {
    const model::Query query{{field.cases.inputs.row(27).data(), 3}, planes, best};
    model->predict(query, before, spread_before, workspace);
    loaded->predict(query, after, spread_after, workspace);
    EXPECT_EQ(before, after);
    EXPECT_EQ(spread_before, spread_after);
  }
}

TEST(PodMlp, ABuildThatDivergedIsLeftOut) {
  const LinearField field;
  const auto rows = field.rows(25);

  test::RecordingLog log;

  EXPECT_NO_THROW(
      (void)make_pod_mlp(std::make_shared<RidgeTrainer>(4))->fit(field.data, rows, {.log = &log}));

  EXPECT_THAT(log.text(), ::testing::HasSubstr("pod_mlp, pressure, build 3 diverged and is lost"));
  EXPECT_THROW((void)make_pod_mlp(std::make_shared<RidgeTrainer>(1000))->fit(field.data, rows, {}),
               NumericalError);
}

TEST(PodMlp, EveryOptionIsPartOfTheKey) {
  const auto trainer = std::make_shared<RidgeTrainer>();
  const auto key = make_pod_mlp(trainer)->key("pressure");
  for (const auto& options : test::each_member_changed(PodMlpOptions{}))
    EXPECT_NE(make_pod_mlp(trainer, options)->key("pressure"), key);
}

TEST(PodMlp, AConstantFieldIsPredictedAsItself) {
  LinearField field;
  field.data.values.setConstant(7);

  const auto model = make_pod_mlp(std::make_shared<RidgeTrainer>())->fit(field.data, field.rows(25), {});

  std::vector<float> predicted(20);
  model::Workspace workspace;
  predict_case(*model, {field.cases.inputs.row(0).data(), 3}, 4, predicted, workspace);
  EXPECT_THAT(predicted, ::testing::Each(7.0F));
}

}  // namespace
}  // namespace elrom::methods
