#include "field_stage.hpp"

#include <chrono>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/auto_method.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/networks/records.hpp"

namespace elrom::study {
namespace {

using Json = nlohmann::ordered_json;

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

// One method by itself, brought into the same form as a choice among several.
methods::AutoFit fit_alone(const FieldStageRequest& request, const std::vector<std::size_t>& rows,
                           const methods::FitContext& context) {
  const auto& data = request.data;
  const auto& method = *request.candidates.front();
  methods::AutoFit fit;
  fit.nrmse = fit.nrmse_by_band = NAN;
  if (request.n_folds > 0) {
    const auto folds = methods::load_grouped_folds(data.cases->loads, rows, request.n_folds);
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
MatrixF residuals_of_new_cases(const FieldStageRequest& request, const methods::AutoFit& fit,
                               const std::vector<std::size_t>& rows, const methods::FitContext& context) {
  const auto& data = request.data;
  const auto folds = methods::spread_folds(*data.cases, rows, 2 * request.n_folds);
  MatrixF residuals = data.values;
  const auto n_columns = static_cast<Eigen::Index>(data.cases->mesh.n_columns);
  for (std::size_t i = 0; i < request.candidates.size(); ++i) {
    const auto& candidate = fit.candidates[i];
    if (candidate.weights.empty()) continue;
    Eigen::RowVectorXf weights(n_columns);
    for (Eigen::Index c = 0; c < n_columns; ++c)
      weights[c] =
          static_cast<float>(candidate.weights[static_cast<std::size_t>(c) % candidate.weights.size()]);
    const MatrixF predictions = request.candidates[i]->cross_predict(data, folds, context);
    for (Eigen::Index first = 0; first < residuals.cols(); first += n_columns)
      residuals.middleCols(first, n_columns).array() -=
          predictions.middleCols(first, n_columns).array().rowwise() * weights.array();
  }
  if (!residuals.allFinite())
    throw NumericalError("a model of other folds predicts numbers that are not finite");
  return residuals;
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

io::TensorFile make_stage(const FieldStageRequest& request, const methods::FitContext& context) {
  const auto begin = std::chrono::steady_clock::now();
  const auto& data = request.data;
  const auto rows = math::all_rows(data.cases->n_cases());
  const auto fit =
      request.name == "auto"
          ? methods::fit_auto(data, rows, request.candidates,
                              {.n_folds = request.n_folds, .band_edges = request.band_edges}, context)
          : fit_alone(request, rows, context);
  io::TensorFile file;
  if (request.n_folds > 0) {
    try {
      model::Uncertainty(residuals_of_new_cases(request, fit, rows, context), data.cases->mesh.n_columns,
                         data.cases->inputs)
          .save(file, "uncertainty");
      file.set_text("has_uncertainty", "yes");
    } catch (const NumericalError& error) {
      // The field itself is sound: intervals that cannot be scored are left out, and that is told.
      context.log->warning(data.info.name + ": no intervals, for " + error.what());
    }
  }
  fit.model->save(file, "model");
  file.set_text("accuracy", accuracy_of(request.name, fit).dump());
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  file.set_text("seconds", base::number(taken.count()));
  return file;
}

std::string digest_of(const FieldStageRequest& request, const methods::FitContext& context) {
  base::Sha256 digest;
  digest.add(field::data_digest(request.data, math::all_rows(request.data.cases->n_cases())));
  digest.add(request.name)
      .add(request.settings_digest)
      .add("intervals on twice as many spread folds, weights by band");
  for (const auto* method : request.candidates) digest.add(method->name());
  digest.add_value(context.seed.value()).add_value(request.n_folds);
  for (const auto& mirror : request.data.cases->mirrors) digest.add(mirror.name);
  return digest.hex();
}

}  // namespace

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
  return {cache.get("model", request.name + "-" + request.data.info.name, digest_of(request, context),
                    [&] { return make_stage(request, context); })};
}

}  // namespace elrom::study
