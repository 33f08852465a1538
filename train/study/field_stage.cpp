#include "field_stage.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <nlohmann/json.hpp>
#include <optional>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/auto_method.hpp"
#include "elrom/methods/cross_validation.hpp"

namespace elrom::study {
namespace {

using Json = nlohmann::ordered_json;

Json finite_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

/// A method whose processor time is kept.
class Timed final : public methods::Method {
 public:
  explicit Timed(const methods::Method& method) : method_(method) {}
  [[nodiscard]] std::string name() const override { return method_.name(); }
  [[nodiscard]] std::string key(const std::string& field) const override { return method_.key(field); }
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const methods::FitContext& context) const override {
    const CostClock clock(cost_);
    return method_.fit(data, cases, context);
  }
  [[nodiscard]] MatrixF predict_folds(const field::FieldData& data, const methods::Folds& folds,
                                      std::span<const std::size_t> wanted,
                                      const methods::FitContext& context) const override {
    const CostClock clock(cost_);
    return method_.predict_folds(data, folds, wanted, context);
  }
  [[nodiscard]] const MethodCost& cost() const { return cost_; }

 private:
  const methods::Method& method_;
  mutable MethodCost cost_;
};

// One method by itself, brought into the same form as a choice among several.
methods::AutoFit fit_alone(const ModelStage& stage, const methods::Method& method,
                           const std::vector<std::size_t>& rows, const methods::FitContext& context) {
  const auto& data = *stage.data;
  methods::AutoFit fit;
  fit.nrmse = fit.nrmse_by_band = NAN;
  if (stage.n_folds > 0) {
    const auto& loads = data.cases->loads;
    const auto folds = methods::folds_of(rows, loads, context, [&](std::span<const std::size_t> some) {
      return methods::load_grouped_folds(loads, some, stage.n_folds);
    });
    fit.nrmse =
        methods::cross_validated_nrmse(data, rows, data.values - method.cross_predict(data, folds, context));
  }
  fit.candidates.push_back({.name = method.name(), .nrmse = fit.nrmse, .weights = {1.0}});
  fit.model = method.fit(data, rows, context);
  return fit;
}

/// Truth minus prediction, each case by a model that never saw it but saw the loads around it, as intervals
/// promise it: the folds that methods compete in leave gaps, which a new case need not meet.
MatrixF residuals_of_new_cases(const ModelStage& stage, const std::vector<const methods::Method*>& methods,
                               const methods::AutoFit& fit, const std::vector<std::size_t>& rows,
                               const methods::FitContext& context) {
  const auto& data = *stage.data;
  const auto folds =
      methods::folds_of(rows, data.cases->loads, context, [&](std::span<const std::size_t> some) {
        return methods::spread_folds(*data.cases, some, interval_folds(stage.n_folds, some.size()));
      });
  MatrixF residuals = data.values;
  const auto n_columns = static_cast<Eigen::Index>(data.cases->mesh.n_columns);
  for (std::size_t i = 0; i < methods.size(); ++i) {
    const auto& candidate = fit.candidates[i];
    if (candidate.weights.empty()) continue;
    Eigen::RowVectorXf weights(n_columns);
    for (Eigen::Index c = 0; c < n_columns; ++c)
      weights[c] =
          static_cast<float>(candidate.weights[static_cast<std::size_t>(c) % candidate.weights.size()]);
    const MatrixF predictions = methods[i]->cross_predict(data, folds, context);
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

Json accuracy_of(const ModelStage& stage, const methods::AutoFit& fit) {
  Json candidates = Json::array();
  for (const auto& candidate : fit.candidates) {
    candidates.push_back({{"name", candidate.name},
                          {"nrmse", finite_or_null(candidate.nrmse)},
                          {"weight", candidate.mean_weight()}});
    if (!candidate.failure.empty()) candidates.back()["failure"] = candidate.failure;
    if (candidate.left_after > 0) candidates.back()["left_after"] = candidate.left_after;
  }
  for (const auto& out : stage.left_out)
    candidates.push_back(
        {{"name", out.name}, {"nrmse", finite_or_null(out.nrmse)}, {"weight", 0.0}, {"cases", out.n_cases}});
  Json accuracy{{"method", stage.name},
                {"kind", fit.model->kind()},
                {"nrmse", finite_or_null(fit.nrmse)},
                {"nrmse_by_band", finite_or_null(fit.nrmse_by_band)},
                {"candidates", candidates}};
  for (const auto row : stage.warm.known) accuracy["known"].push_back(stage.data->cases->names[row]);
  return accuracy;
}

}  // namespace

io::TensorFile ModelStage::compute(const methods::FitContext& running) const {
  auto context = running;
  context.seed = seed;
  if (warm.model != nullptr) context.warm = &warm;
  const auto rows = math::all_rows(data->cases->n_cases());
  MethodCost cost;
  std::optional<CostClock> clock(cost);
  std::deque<Timed> timed;
  std::vector<const methods::Method*> all;
  for (const auto& candidate : candidates) all.push_back(&timed.emplace_back(*candidate.method));
  const auto fit = name == "auto" ? methods::fit_auto(*data, rows, all,
                                                      {.n_folds = n_folds, .band_edges = band_edges}, context)
                                  : fit_alone(*this, *all.front(), rows, context);
  io::TensorFile file;
  auto accuracy = accuracy_of(*this, fit);
  if (n_folds > 0) {
    try {
      auto residuals = residuals_of_new_cases(*this, all, fit, rows, context);
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
  clock.reset();
  file.set_text("seconds", base::number(cost.seconds));
  Json costs;
  for (const auto& method : timed)
    costs[method.name()] = {{"seconds", method.cost().seconds},
                            {"processor_seconds", method.cost().processor_seconds}};
  file.set_text("costs", costs.dump());
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

std::map<std::string, MethodCost> FieldStage::costs() const {
  std::map<std::string, MethodCost> costs;
  if (!file.has_text("costs")) return costs;
  const auto kept = Json::parse(file.text("costs"));
  for (const auto& [name, cost] : kept.items())
    costs[name] = {cost.at("seconds").get<double>(), cost.at("processor_seconds").get<double>()};
  return costs;
}

FieldStage fit_field(const FieldStageRequest& request, const io::StageCache& cache,
                     const methods::FitContext& context) {
  check(!request.candidates.empty(), "fit_field: a method");
  ModelStage stage{.name = request.name,
                   .candidates = {},
                   .data = &request.data,
                   .band_edges = request.name == "auto" ? request.band_edges : std::vector<double>(),
                   .n_folds = request.n_folds,
                   .seed = context.seed,
                   .warm = request.warm,
                   .left_out = request.left_out};
  for (const auto* method : request.candidates) {
    if (std::ranges::find(request.left_out, method->name(), &LeftOut::name) == request.left_out.end())
      stage.candidates.push_back({method, request.data.info.name});
  }
  return {cache.get(request.name + "-" + request.data.info.name, stage, context)};
}

}  // namespace elrom::study
