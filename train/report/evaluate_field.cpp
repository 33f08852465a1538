#include "evaluate_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/banded_networks.hpp"
#include "elrom/model/composite_models.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

/// Predictions of one method, (n_cases, n_cells); empty where the bundle lacks the field.
MatrixF predict_cases(const FieldTask& task, const BundleFile& bundle, std::optional<double> level = {},
                      MatrixF* half_width = nullptr) {
  const model::BundleReader reader(bundle.path);
  const auto& fields = reader.info().fields;
  if (std::none_of(fields.begin(), fields.end(), [&](const auto& f) { return f.name == task.info.name; }))
    return {};
  const model::Predictor predictor(bundle.path, {.fields = {task.info.name}, .interval_level = level});
  const auto n_cases = static_cast<Eigen::Index>(task.cases.scored.size());
  const auto n_cells = static_cast<Eigen::Index>(predictor.size());
  MatrixF values(n_cases, n_cells);
  if (half_width != nullptr) half_width->resize(n_cases, n_cells);
  model::Predictor::Scratch scratch;
  for (Eigen::Index i = 0; i < n_cases; ++i)
    predictor.predict(case_inputs(task.cases, static_cast<std::size_t>(i)),
                      {values.row(i).data(), predictor.size()},
                      half_width != nullptr ? std::span<float>(half_width->row(i).data(), predictor.size())
                                            : std::span<float>{},
                      scratch, task.n_threads);
  return values;
}

std::span<const float> row(const MatrixF& values, std::size_t i) {
  return {values.row(static_cast<Eigen::Index>(i)).data(), static_cast<std::size_t>(values.cols())};
}

MethodField score_method(const FieldTask& task, const MatrixF& truth, const MatrixF& prediction,
                         const TrainingStatistics& statistics) {
  MethodField result;
  result.available = prediction.size() > 0;
  if (!result.available) return result;
  for (std::size_t i = 0; i < task.cases.scored.size(); ++i) {
    result.cases.push_back(error_sums(row(truth, i), row(prediction, i), statistics));
    result.pooled += result.cases.back();
    const auto worst = worst_cell(row(truth, i), row(prediction, i));
    const auto centre = task.store.mesh().centre.row(static_cast<Eigen::Index>(worst.cell));
    result.worst.push_back({worst, {centre(0), centre(1), centre(2)}});
  }
  return result;
}

/// Networks, and the columns of the field that each of their own stands for.
struct FoundNetworks {
  const model::BandedNetworks* networks = nullptr;  // nullptr: the model is something else
  std::vector<std::vector<std::size_t>> columns;
};
FoundNetworks networks_of(const model::FieldModel& model) {
  if (const auto* scaled = dynamic_cast<const model::ScaledModel*>(&model))
    return networks_of(*scaled->model());
  if (const auto* unfolded = dynamic_cast<const model::UnfoldedModel*>(&model)) {
    auto found = networks_of(*unfolded->model());
    if (!unfolded->fold().empty()) found.columns = unfolded->fold().orbits();
    return found;
  }
  FoundNetworks found{dynamic_cast<const model::BandedNetworks*>(&model), {}};
  for (std::size_t c = 0; c < model.n_columns(); ++c) found.columns.push_back({c});
  return found;
}

// Cells of the field a submodel answers for, in all planes.
std::vector<std::size_t> cells_of(const model::Submodel& submodel, std::size_t n_planes,
                                  std::size_t n_columns, const FoundNetworks& of) {
  std::vector<std::size_t> cells;
  for (std::size_t plane = 0; plane < n_planes; ++plane)
    for (std::size_t j = 0; j < submodel.columns.size(); ++j)
      if (submodel.answers(plane, j))
        for (const std::size_t column : of.columns[static_cast<std::size_t>(submodel.columns[j])])
          cells.push_back(plane * n_columns + column);
  return cells;
}

std::vector<SubmodelScore> score_submodels(const FoundNetworks& found, std::size_t n_columns,
                                           const MatrixF& truth, const MatrixF& prediction,
                                           const TrainingStatistics& statistics) {
  std::vector<SubmodelScore> scores;
  for (const auto& submodel : found.networks->parts().submodels) {
    const auto cells =
        cells_of(submodel, static_cast<std::size_t>(truth.cols()) / n_columns, n_columns, found);
    SubmodelScore score{.name = submodel.name, .n_cells = cells.size()};
    for (Eigen::Index i = 0; i < truth.rows() && !cells.empty(); ++i)
      score.sums += error_sums(row(truth, static_cast<std::size_t>(i)),
                               row(prediction, static_cast<std::size_t>(i)), statistics, cells);
    scores.push_back(std::move(score));
  }
  return scores;
}

// Energy of the truth's noise in each scored case, from the sets of repeated runs.
std::vector<double> noise_of(const FieldTask& task) {
  if (task.cases.repeats.empty()) return {};
  const auto load_of = [&](std::size_t row) { return task.store.cases()[row].inputs.load; };
  std::vector<double> energies, measured_loads, loads;
  for (const auto& runs : task.cases.repeats) {
    energies.push_back(noise_energy(task.store.read(task.info.name, runs)));
    measured_loads.push_back(load_of(runs.front()));
  }
  for (const std::size_t row : task.cases.scored) loads.push_back(load_of(row));
  return noise_at_loads(measured_loads, energies, loads);
}

void score_against_averages(const FieldTask& task, const std::vector<MatrixF>& predictions,
                            const TrainingStatistics& statistics, FieldAccuracy& result) {
  if (!task.cases.all_repeated()) return;
  auto truth = averaged_truth(task.store, task.info.name, task.cases);
  for (std::size_t m = 0; m < predictions.size(); ++m)
    if (predictions[m].size() > 0)
      result.methods[m].averaged = score_method(task, truth.values, predictions[m], statistics).cases;
  result.averaged_noise = std::move(truth.noise);
}

void budget_errors(const MatrixF& training, const MatrixF& truth, FieldAccuracy& result) {
  const CaseSpan span(training);
  std::vector<double> residuals(span.n_modes() + 1, 0.0);
  for (Eigen::Index i = 0; i < truth.rows(); ++i) {
    const auto of_case = span.residuals(row(truth, static_cast<std::size_t>(i)));
    for (std::size_t r = 0; r < residuals.size(); ++r) residuals[r] += of_case[r];
  }
  const auto& sums = result.methods.front().pooled;
  for (const double residual : residuals)
    result.compression_nrmse.push_back(math::nrmse(residual, residuals.front()));
  result.budget = error_budget(sums, result.noise_energy(), residuals.back());
  if (!result.noise.empty() && sums.departure > 0)
    result.noise_nrmse = math::nrmse(result.noise_energy(), sums.departure);
}

// Measured coverage at every level; the mean half-widths of planes at 90 % go to the drawings.
void measure_coverage(const FieldTask& task, const MatrixF& truth, FieldAccuracy& result,
                      FieldFigures* figures) {
  const auto& bundle = task.bundles.front();
  if (!model::BundleReader(bundle.path).uncertainty(task.info.name)) return;
  for (const double level : coverage_levels) {
    auto& shares =
        result.coverage.emplace_back(task.cases.scored.size(), std::numeric_limits<double>::quiet_NaN());
    MatrixF half_width, prediction;
    try {
      prediction = predict_cases(task, bundle, level, &half_width);
    } catch (const UsageError&) {
      continue;  // so few cases cannot promise this level
    }
    for (std::size_t i = 0; i < shares.size(); ++i) {
      shares[i] = covered_share(row(truth, i), row(prediction, i), row(half_width, i));
      if (figures != nullptr && level == 0.9)
        figures->half_width.push_back(plane_means(task.store.mesh(), row(half_width, i)));
    }
  }
}

// As the trainer left it in the bundle for people.
Choice choice_of(const std::string& accuracy_json, const std::string& field) {
  const auto number = [](const nlohmann::json& node, const char* key) {
    return node.contains(key) && node[key].is_number() ? node[key].get<double>() : std::nan("");
  };
  const auto root = nlohmann::json::parse(accuracy_json, nullptr, false);
  if (!root.is_object() || !root.contains(field) || !root[field].contains("candidates"))
    return {{}, std::nan(""), std::nan(""), {}};
  Choice choice{{}, number(root[field], "nrmse"), number(root[field], "nrmse_by_band"), {}};
  for (const auto& candidate : root[field]["candidates"])
    choice.candidates.push_back({candidate.value("name", ""), number(candidate, "nrmse"),
                                 candidate.value("weight", 0.0), candidate.value("left_after", 0)});
  return choice;
}

// Members and weights; empty for one member alone.
std::string blend_text(const Choice& choice) {
  std::vector<std::string> members;
  for (const auto& candidate : choice.candidates)
    if (candidate.weight > 0)
      members.push_back(fmt::format("{} {:.2f}", method_label(candidate.name), candidate.weight));
  return members.size() > 1 ? base::join(members, ", ") : "";
}

struct Range {
  double low, high;
};
Range range_of(const MatrixF& values) { return {values.minCoeff(), values.maxCoeff()}; }

FieldFigures draw(const FieldTask& task, const Figures& figures, const MatrixF& truth,
                  const std::vector<MatrixF>& predictions) {
  constexpr std::size_t error_bins = 61, parity_bins = 48;
  FieldFigures field;
  const auto& mesh = task.store.mesh();
  for (std::size_t i = 0; i < task.cases.scored.size(); ++i) {
    auto& profiles = field.profiles.emplace_back();
    profiles.push_back(plane_means(mesh, row(truth, i)));
    for (const auto& prediction : predictions)
      profiles.push_back(prediction.size() > 0 ? plane_means(mesh, row(prediction, i))
                                               : std::vector<double>{});
    auto& cuts = field.cuts.emplace_back();
    cuts.push_back(on_cuts(figures.cuts, row(truth, i)));
    for (const std::size_t m : figures.cut_methods)
      cuts.push_back(predictions[m].size() > 0 ? on_cuts(figures.cuts, row(predictions[m], i))
                                               : std::vector<float>{});
  }
  const auto& model = predictions.front();
  const double reach =
      3 * std::sqrt((model - truth).cast<double>().squaredNorm() / static_cast<double>(truth.size()));
  for (const auto& prediction : predictions) {
    auto& histogram = field.errors.emplace_back(-reach, reach, error_bins);
    for (Eigen::Index k = 0; k < prediction.size(); ++k)
      histogram.add(double{prediction.data()[k]} - truth.data()[k]);
  }
  const auto [low, high] = range_of(truth);
  field.parity = ParityMap(low, high, parity_bins);
  for (Eigen::Index k = 0; k < truth.size(); ++k) field.parity.add(truth.data()[k], model.data()[k]);
  return field;
}

}  // namespace

FieldAccuracy evaluate_field(const FieldTask& task, Figures* figures) {
  FieldAccuracy result{.info = task.info};
  const auto training = task.store.read(task.info.name, task.cases.building);
  const auto truth = task.store.read(task.info.name, task.cases.scored);
  const auto statistics = training_statistics(training, task.store.mesh().n_columns);
  std::vector<MatrixF> predictions;
  for (const auto& bundle : task.bundles) {
    predictions.push_back(predict_cases(task, bundle));
    result.methods.push_back(score_method(task, truth, predictions.back(), statistics));
    if (!result.methods.back().available) continue;
    const auto model = model::BundleReader(bundle.path).model(task.info.name);
    result.methods.back().kind = model->kind();
    const auto choice = choice_of(model::BundleReader(bundle.path).info().accuracy_json, task.info.name);
    result.methods.back().detail = blend_text(choice);
    if (result.methods.size() == 1) {
      result.choice = choice;
      result.choice.scale = model::scale_of(*model);
    }
    if (const auto found = networks_of(*model); found.networks != nullptr && result.submodels.empty())
      result.submodels = score_submodels(found, model->n_columns(), truth, predictions.back(), statistics);
  }
  result.noise = noise_of(task);
  score_against_averages(task, predictions, statistics, result);
  budget_errors(training, truth, result);
  if (figures != nullptr) figures->fields.push_back(draw(task, *figures, truth, predictions));
  measure_coverage(task, truth, result, figures != nullptr ? &figures->fields.back() : nullptr);
  return result;
}

Figures start_figures(const field::Mesh& mesh, const std::vector<BundleFile>& bundles, std::size_t n_fields,
                      std::size_t n_cases) {
  constexpr std::size_t most_values =
      2'000'000;  // two bytes each, a third more as text: the page stays below 8 MB
  Figures figures{.cuts = middle_cuts(mesh), .heights = mesh.plane_heights()};
  std::size_t per_series = 0;
  for (const auto& cut : figures.cuts) per_series += cut.cells.size() * n_fields * n_cases;
  for (std::size_t m = 0; m < bundles.size(); ++m)
    if (m == 0 || (m + 2) * per_series <= most_values) figures.cut_methods.push_back(m);
  return figures;
}

}  // namespace elrom::report
