#include "elrom/study/cross_validation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"

namespace elrom::study {

Folds load_grouped_folds(std::span<const double> loads, std::span<const std::size_t> cases,
                         std::size_t n_folds, std::size_t blocks_per_fold) {
  if (cases.size() < 2) {
    throw UsageError({.what = "cross-validation needs more cases",
                      .found = std::to_string(cases.size()),
                      .expected = "at least 2"});
  }
  std::vector<std::size_t> order(cases.begin(), cases.end());
  const auto load = [&](std::size_t row) {
    return std::isnan(loads[row]) ? std::numeric_limits<double>::infinity() : loads[row];
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return load(a) < load(b); });

  n_folds = std::clamp<std::size_t>(n_folds, 2, order.size());
  const std::size_t n_blocks = std::min(n_folds * std::max<std::size_t>(blocks_per_fold, 1), order.size());
  Folds folds(n_folds);
  for (std::size_t i = 0; i < order.size(); ++i)
    folds[i * n_blocks / order.size() % n_folds].push_back(order[i]);
  for (auto& fold : folds) std::sort(fold.begin(), fold.end());
  return folds;
}

std::vector<std::size_t> rows_without(const Folds& folds, std::size_t left_out) {
  std::vector<std::size_t> rows;
  for (std::size_t k = 0; k < folds.size(); ++k) {
    if (k != left_out) rows.insert(rows.end(), folds[k].begin(), folds[k].end());
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

void predict_case(const model::FieldModel& model, std::span<const double> inputs, std::size_t n_planes,
                  std::span<float> values, model::Workspace& workspace) {
  std::vector<std::int32_t> planes(n_planes);
  std::iota(planes.begin(), planes.end(), 0);
  model.predict({.inputs = inputs, .planes = planes}, values, {}, workspace);
}

MatrixF cross_predict_by_fitting(const Method& method, const FieldData& data, const Folds& folds,
                                 const FitContext& context, bool parallel) {
  MatrixF predictions = MatrixF::Zero(data.values.rows(), data.values.cols());
  const auto& cases = *data.cases;
  const auto one_fold = [&](std::size_t k, const FitContext& fold_context) {
    const auto model = method.fit(data, rows_without(folds, k), fold_context);
    model::Workspace workspace;
    for (std::size_t row : folds[k]) {
      const auto i = static_cast<Eigen::Index>(row);
      const auto inputs =
          std::span(cases.inputs.row(i).data(), static_cast<std::size_t>(cases.inputs.cols()));
      const auto values = std::span(predictions.row(i).data(), static_cast<std::size_t>(predictions.cols()));
      predict_case(*model, inputs, cases.mesh.n_planes, values, workspace);
    }
  };
  FitContext fold_context = context;
  if (parallel) fold_context.n_threads = 1;
  base::parallel_for(
      folds.size(), parallel ? context.n_threads : 1, [&](std::size_t k, int) { one_fold(k, fold_context); },
      context.stop);
  return predictions;
}

MatrixF Method::cross_predict(const FieldData& data, const Folds& folds, const FitContext& context) const {
  return cross_predict_by_fitting(*this, data, folds, context, false);
}

}  // namespace elrom::study
