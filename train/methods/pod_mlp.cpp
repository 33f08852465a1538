#include "elrom/methods/pod_mlp.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/field/symmetry.hpp"
#include "elrom/math/pod.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/mlp_coefficients.hpp"
#include "elrom/model/pod_model.hpp"
#include "pod_modes.hpp"

namespace elrom::methods {
namespace {

/// Cases and, behind them, their mirror images: image g of case i is row g * n_cases + i.
struct Snapshots {
  std::size_t n_cases = 0;
  MatrixD inputs;             //!< SI, (n_rows, n_inputs)
  MatrixF values;             //!< SI, (n_rows, n_cells)
  std::vector<double> loads;  //!< (n_cases)
  std::vector<std::size_t> all_rows;
};

void add_image(Snapshots& to, std::size_t g, const field::Mirror& mirror, field::Parity parity) {
  const auto sign = static_cast<float>(mirror.field_sign(parity));
  const auto n_inputs = static_cast<std::size_t>(to.inputs.cols());
  for (std::size_t i = 0; i < to.n_cases; ++i) {
    const auto from = static_cast<Eigen::Index>(i), row = static_cast<Eigen::Index>(g * to.n_cases + i);
    const auto mirrored = mirror.apply_to_inputs({to.inputs.row(from).data(), n_inputs});
    std::copy(mirrored.begin(), mirrored.end(), to.inputs.row(row).data());
    for (Eigen::Index cell = 0; cell < to.values.cols(); ++cell)
      to.values(row, cell) = sign * to.values(from, mirror.cell_from[static_cast<std::size_t>(cell)]);
  }
}

Snapshots take_snapshots(const field::FieldData& data, std::span<const std::size_t> cases, bool mirrors) {
  const auto& set = *data.cases;
  std::vector<field::Mirror> group;
  if (mirrors) group = field::symmetry_group(set.mirrors, set.schema.size(), set.mesh.n_cells());
  const std::size_t n_images = std::max<std::size_t>(1, group.size());
  Snapshots snapshots;
  snapshots.n_cases = cases.size();
  const auto n_rows = static_cast<Eigen::Index>(cases.size() * n_images);
  snapshots.inputs.resize(n_rows, set.inputs.cols());
  snapshots.values.resize(n_rows, data.values.cols());
  for (std::size_t i = 0; i < cases.size(); ++i) {
    const auto to = static_cast<Eigen::Index>(i), from = static_cast<Eigen::Index>(cases[i]);
    snapshots.inputs.row(to) = set.inputs.row(from);
    snapshots.values.row(to) = data.values.row(from);
    snapshots.loads.push_back(set.loads[cases[i]]);
  }
  for (std::size_t g = 1; g < n_images; ++g) add_image(snapshots, g, group[g], data.info.parity);
  snapshots.all_rows.resize(static_cast<std::size_t>(n_rows));
  std::iota(snapshots.all_rows.begin(), snapshots.all_rows.end(), 0);
  return snapshots;
}

/// Inputs and scaled coefficients of every snapshot.
struct Table {
  MatrixF inputs, targets;
};

MatrixF take(const MatrixF& from, std::span<const std::size_t> rows) {
  MatrixF taken(static_cast<Eigen::Index>(rows.size()), from.cols());
  for (std::size_t i = 0; i < rows.size(); ++i)
    taken.row(static_cast<Eigen::Index>(i)) = from.row(static_cast<Eigen::Index>(rows[i]));
  return taken;
}

/// @param fold cases that stop the training; their images neither train nor stop
networks::TrainingProblem problem_of(const Table& table, const Snapshots& snapshots,
                                     const std::vector<std::size_t>& fold) {
  std::vector<bool> left_out(snapshots.n_cases, false);
  for (const std::size_t i : fold) left_out[i] = true;
  std::vector<std::size_t> rows;
  for (const std::size_t row : snapshots.all_rows)
    if (!left_out[row % snapshots.n_cases]) rows.push_back(row);
  networks::TrainingProblem problem;
  problem.train_inputs = take(table.inputs, rows);
  problem.train_targets = take(table.targets, rows);
  problem.validation_inputs = take(table.inputs, fold);
  problem.validation_targets = take(table.targets, fold);
  return problem;
}

/// Sum over validation records of the squared residual of each target.
Eigen::VectorXd squared_residuals(const model::Network& network, const networks::TrainingProblem& problem) {
  MatrixF predicted(problem.validation_inputs.rows(), problem.validation_targets.cols());
  model::Workspace workspace;
  network.forward(problem.validation_inputs, predicted, workspace);
  return (predicted - problem.validation_targets).cast<double>().cwiseAbs2().colwise().sum().transpose();
}

class PodMlp final : public Method {
 public:
  PodMlp(std::shared_ptr<const networks::Trainer> trainer, PodMlpOptions options)
      : trainer_(std::move(trainer)), options_(std::move(options)) {
    check(trainer_ != nullptr, "pod_mlp needs a trainer");
  }

  [[nodiscard]] std::string name() const override { return "pod_mlp"; }
  [[nodiscard]] std::string key(const std::string&) const override {
    return base::digest_of_members(name(), options_, trainer_);
  }

  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const override {
    const Snapshots snapshots = take_snapshots(data, cases, options_.mirrors);
    math::Pod pod = math::make_pod(snapshots.values, snapshots.all_rows, {.n_modes = options_.most_modes},
                                   context.n_threads);
    if (pod.n_modes() == 0) {  // all cases are equal: one mode of zeros, which no network moves
      pod.modes = MatrixF::Zero(1, data.values.cols());
      pod.coefficients = MatrixD::Zero(snapshots.values.rows(), 1);
      pod.energies = Eigen::VectorXd::Zero(1);
    }
    Built built = best_build(data, snapshots, pod.coefficients, context);
    const auto n = predictable_modes(built.parts.variance, energies_of(pod.coefficients));
    if (n < pod.modes.rows()) {
      keep_modes(pod, n);
      built = build(data, snapshots, pod.coefficients, *built.recipe, context);
    }
    return model::make_pod_model(
        name(), pod.mean, pod.modes, truncated_deviation(snapshots.values, snapshots.all_rows, pod),
        data.cases->mesh.n_columns, std::make_shared<model::MlpCoefficients>(std::move(built.parts)));
  }

  [[nodiscard]] MatrixF predict_folds(const field::FieldData& data, const Folds& folds,
                                      std::span<const std::size_t> wanted,
                                      const FitContext& context) const override {
    return predict_by_fitting(*this, data, folds, wanted, context, true);
  }

 private:
  [[nodiscard]] Eigen::VectorXd coefficient_scale(const MatrixD& coefficients) const {
    const Eigen::VectorXd deviation = (coefficients.cwiseAbs2().colwise().mean()).cwiseSqrt().transpose();
    const double largest = deviation.maxCoeff();
    if (!(largest > 0)) return Eigen::VectorXd::Ones(deviation.size());
    // Modes that are rounding beside the first share its scale and so hardly count.
    const Eigen::ArrayXd share = (deviation.array() / largest).max(1e-3);
    return largest * share.pow(options_.equalise);
  }

  struct Built {
    model::MlpCoefficients::Parts parts;
    const PodMlpRecipe* recipe = nullptr;
  };

  /// Mean over the snapshots of each coefficient's square.
  [[nodiscard]] static Eigen::VectorXd energies_of(const MatrixD& coefficients) {
    return coefficients.cwiseAbs2().colwise().mean().transpose();
  }

  /// The earlier model's alone, where it had one: which one it is costs the most and changes the least.
  [[nodiscard]] std::vector<const PodMlpRecipe*> recipes(const FitContext& context) const {
    const auto* earlier = context.warm == nullptr ? nullptr : context.warm->mlp();
    std::vector<const PodMlpRecipe*> all;
    for (const auto& recipe : options_.recipes) {
      if (earlier != nullptr && !recipe.name.empty() && recipe.name == earlier->parts().recipe)
        return {&recipe};
      all.push_back(&recipe);
    }
    return all;
  }

  /// By the recipe of the least error. @throws NumericalError when all fail
  [[nodiscard]] Built best_build(const field::FieldData& data, const Snapshots& snapshots,
                                 const MatrixD& coefficients, const FitContext& context) const {
    Built best;
    const Eigen::VectorXd energies = energies_of(coefficients);
    for (const auto* recipe : recipes(context)) {
      Built built = build(data, snapshots, coefficients, *recipe, context);
      if (built.parts.builds.empty()) continue;
      const bool better = best.recipe == nullptr || least_error(built.parts.variance, energies) <
                                                        least_error(best.parts.variance, energies);
      if (better) best = std::move(built);
    }
    if (best.recipe == nullptr)
      throw NumericalError({.what = "every network of pod_mlp diverged",
                            .where = data.info.name,
                            .advice = "look for wild cells with elrom-data check"});
    return best;
  }

  [[nodiscard]] Built build(const field::FieldData& data, const Snapshots& snapshots,
                            const MatrixD& coefficients, const PodMlpRecipe& recipe,
                            const FitContext& context) const {
    Built built{.parts = {}, .recipe = &recipe};
    auto& parts = built.parts;
    parts.recipe = recipe.name;
    parts.inputs = model::InputScaler::fit(snapshots.inputs, options_.relevance);
    parts.scale = coefficient_scale(coefficients);
    Table table{MatrixF(snapshots.inputs.rows(), snapshots.inputs.cols()),
                (coefficients * parts.scale.cwiseInverse().asDiagonal()).cast<float>()};
    const auto n_inputs = static_cast<std::size_t>(snapshots.inputs.cols());
    for (Eigen::Index r = 0; r < snapshots.inputs.rows(); ++r)
      parts.inputs.apply({snapshots.inputs.row(r).data(), n_inputs}, {table.inputs.row(r).data(), n_inputs});
    train_builds(data, snapshots, table, recipe, parts, context);
    return built;
  }

  void train_builds(const field::FieldData& data, const Snapshots& snapshots, const Table& table,
                    const PodMlpRecipe& recipe, model::MlpCoefficients::Parts& parts,
                    const FitContext& context) const {
    std::vector<std::size_t> cases(snapshots.n_cases);
    std::iota(cases.begin(), cases.end(), 0);
    const auto n_builds = static_cast<std::size_t>(options_.builds);
    const Folds folds = load_grouped_folds(snapshots.loads, cases, n_builds);
    std::vector<networks::TrainingResult> results(n_builds);
    std::vector<Eigen::VectorXd> residuals(n_builds);
    const base::Seed seed = context.seed.derive("pod_mlp").derive(data.info.name);
    base::parallel_for(
        n_builds, context.n_trainings(),
        [&](std::size_t b, int) {
          const networks::TrainingProblem problem = problem_of(table, snapshots, folds[b % folds.size()]);
          results[b] = trainer_->train(problem, recipe.hyperparameters, recipe.budget, seed.derive(b),
                                       nullptr, context.stop);
          networks::tell_divergence(
              results[b], name() + ", " + data.info.name + ", build " + std::to_string(b), *context.log);
          if (!results[b].diverged) residuals[b] = squared_residuals(results[b].network, problem);
        },
        context.stop);
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(table.targets.cols());
    double count = 0;
    for (std::size_t b = 0; b < n_builds; ++b) {
      if (results[b].diverged) continue;
      parts.builds.push_back(std::move(results[b].network));
      parts.scores.push_back(results[b].validation_mse);
      sum += residuals[b];
      count += static_cast<double>(folds[b % folds.size()].size());
    }
    parts.variance = (sum / std::max(count, 1.0)).array() * parts.scale.array().square();
  }

  std::shared_ptr<const networks::Trainer> trainer_;
  PodMlpOptions options_;
};

}  // namespace

std::vector<PodMlpRecipe> pod_mlp_recipes() {
  const networks::Hyperparameters noisy{.learning_rate = 3e-3,
                                        .n_layers = 2,
                                        .n_units = 64,
                                        .batch_size = 32,
                                        .weight_decay = 1e-2,
                                        .activation = model::Activation::tanh};
  networks::Hyperparameters smooth = noisy;
  smooth.weight_decay = 1e-4;
  smooth.batch_size = 16;
  smooth.learning_rate = 2e-3;
  return {{noisy, {.max_epochs = 300, .patience = 40}, "noisy"},
          {smooth, {.max_epochs = 2000, .patience = 150}, "smooth"}};
}

std::unique_ptr<Method> make_pod_mlp(std::shared_ptr<const networks::Trainer> trainer,
                                     const PodMlpOptions& options) {
  return std::make_unique<PodMlp>(std::move(trainer), options);
}

}  // namespace elrom::methods
