#include "field_stage.hpp"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/auto_method.hpp"
#include "elrom/methods/cross_validation.hpp"

namespace elrom::study {
namespace {

using Json = nlohmann::ordered_json;

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

// One method by itself, brought into the same form as a choice among several.
methods::AutoFit fit_alone(const ModelStage& stage, const std::vector<std::size_t>& rows,
                           const methods::FitContext& context) {
  const auto& data = *stage.data;
  const auto& method = *stage.candidates.front().method;
  methods::AutoFit fit;
  fit.nrmse = fit.nrmse_by_band = NAN;
  if (stage.n_folds > 0) {
    const auto folds = methods::load_grouped_folds(data.cases->loads, rows, stage.n_folds);
    fit.nrmse =
        methods::cross_validated_nrmse(data, rows, data.values - method.cross_predict(data, folds, context));
  }
  fit.candidates.push_back({.name = method.name(), .nrmse = fit.nrmse, .weights = {1.0}});
  fit.model = method.fit(data, rows, context);
  return fit;
}

/// Truth minus prediction, each case by a model that never saw it but saw the loads around it, as intervals
/// promise it: the folds that methods compete in leave gaps, which a new case need not meet. Twice as many of
/// them, because a model that misses as many cases as those do errs more than the one that will answer.
MatrixF residuals_of_new_cases(const ModelStage& stage, const methods::AutoFit& fit,
                               const std::vector<std::size_t>& rows, const methods::FitContext& context) {
  const auto& data = *stage.data;
  const auto folds = methods::spread_folds(*data.cases, rows, 2 * stage.n_folds);
  MatrixF residuals = data.values;
  const auto n_columns = static_cast<Eigen::Index>(data.cases->mesh.n_columns);
  for (std::size_t i = 0; i < stage.candidates.size(); ++i) {
    const auto& candidate = fit.candidates[i];
    if (candidate.weights.empty()) continue;
    Eigen::RowVectorXf weights(n_columns);
    for (Eigen::Index c = 0; c < n_columns; ++c)
      weights[c] =
          static_cast<float>(candidate.weights[static_cast<std::size_t>(c) % candidate.weights.size()]);
    const MatrixF predictions = stage.candidates[i].method->cross_predict(data, folds, context);
    for (Eigen::Index first = 0; first < residuals.cols(); first += n_columns)
      residuals.middleCols(first, n_columns).array() -=
          predictions.middleCols(first, n_columns).array().rowwise() * weights.array();
  }
  if (!residuals.allFinite())
    throw NumericalError("a model of other folds predicts numbers that are not finite");
  return residuals;
}

/// Of each case, for the gate between this model and a later one.
Json squared_errors(const MatrixF& residuals) {
  Json errors = Json::array();
  for (Eigen::Index i = 0; i < residuals.rows(); ++i)
    errors.push_back(residuals.row(i).cast<double>().squaredNorm());
  return errors;
}

Json accuracy_of(const std::string& name, const methods::AutoFit& fit) {
  Json candidates = Json::array();
  for (const auto& candidate : fit.candidates) {
    candidates.push_back({{"name", candidate.name},
                          {"nrmse", finite_or_null(candidate.nrmse)},
                          {"weight", candidate.mean_weight()}});
    if (!candidate.failure.empty()) candidates.back()["failure"] = candidate.failure;
  }
  return {{"method", name},
          {"kind", fit.model->kind()},
          {"nrmse", finite_or_null(fit.nrmse)},
          {"nrmse_by_band", finite_or_null(fit.nrmse_by_band)},
          {"candidates", candidates}};
}

}  // namespace

io::TensorFile ModelStage::compute(const methods::FitContext& running) const {
  auto context = running;
  context.seed = seed;
  const auto begin = std::chrono::steady_clock::now();
  const auto rows = math::all_rows(data->cases->n_cases());
  std::vector<const methods::Method*> all;
  for (const auto& candidate : candidates) all.push_back(candidate.method);
  const auto fit = name == "auto" ? methods::fit_auto(*data, rows, all,
                                                      {.n_folds = n_folds, .band_edges = band_edges}, context)
                                  : fit_alone(*this, rows, context);
  io::TensorFile file;
  auto accuracy = accuracy_of(name, fit);
  if (n_folds > 0) {
    try {
      auto residuals = residuals_of_new_cases(*this, fit, rows, context);
      accuracy["squared_errors"] = squared_errors(residuals);
      model::Uncertainty(std::move(residuals), data->cases->mesh.n_columns, data->cases->inputs)
          .save(file, "uncertainty");
      file.set_text("has_uncertainty", "yes");
    } catch (const NumericalError& error) {
      // The field itself is sound: intervals that cannot be scored are left out, and that is told.
      context.log->warning(data->info.name + ": no intervals, for " + error.what());
    }
  }
  fit.model->save(file, "model");
  file.set_text("accuracy", accuracy.dump());
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  file.set_text("seconds", base::number(taken.count()));
  return file;
}

std::shared_ptr<const model::FieldModel> FieldStage::model() const {
  return model::load_field_model(file, "model");
}

std::shared_ptr<const model::Uncertainty> FieldStage::uncertainty() const {
  if (!file.has_text("has_uncertainty")) return nullptr;
  return std::make_shared<const model::Uncertainty>(model::Uncertainty::load(file, "uncertainty"));
}

double FieldStage::nrmse() const {
  const auto value = Json::parse(accuracy())["nrmse"];
  return value.is_number() ? value.get<double>() : NAN;
}

double FieldStage::seconds() const {
  return file.has_text("seconds") ? base::to_double(file.text("seconds")).value_or(NAN) : NAN;
}

FieldStage fit_field(const FieldStageRequest& request, const io::StageCache& cache,
                     const methods::FitContext& context) {
  check(!request.candidates.empty(), "fit_field: a method");
  ModelStage stage{.name = request.name,
                   .candidates = {},
                   .data = &request.data,
                   .band_edges = request.name == "auto" ? request.band_edges : std::vector<double>(),
                   .n_folds = request.n_folds,
                   .seed = context.seed};
  for (const auto* method : request.candidates) stage.candidates.push_back({method, request.data.info.name});
  return {cache.get(request.name + "-" + request.data.info.name, stage, context)};
}

}  // namespace elrom::study
