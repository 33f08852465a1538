#include "elrom/methods/cross_validation.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::methods {

namespace {

/// A load that is not given counts as the largest.
double place_of(double load) { return std::isnan(load) ? std::numeric_limits<double>::infinity() : load; }

std::size_t possible_folds(std::size_t n_folds, std::size_t n_cases) {
  if (n_cases < 2) {
    throw UsageError({.what = "cross-validation needs more cases",
                      .found = std::to_string(n_cases),
                      .expected = "at least 2"});
  }
  return std::clamp<std::size_t>(n_folds, 2, n_cases);
}

}  // namespace

Folds load_grouped_folds(std::span<const double> loads, std::span<const std::size_t> cases,
                         std::size_t n_folds, std::size_t blocks_per_fold) {
  n_folds = possible_folds(n_folds, cases.size());
  std::vector<std::size_t> order(cases.begin(), cases.end());
  std::ranges::stable_sort(order, {}, [&](std::size_t row) { return place_of(loads[row]); });
  const std::size_t n_blocks = std::min(n_folds * std::max<std::size_t>(blocks_per_fold, 1), order.size());
  Folds folds(n_folds);
  for (std::size_t i = 0; i < order.size(); ++i)
    folds[i * n_blocks / order.size() % n_folds].push_back(order[i]);
  for (auto& fold : folds) std::sort(fold.begin(), fold.end());
  return folds;
}

Folds spread_folds(const field::CaseSet& cases, std::span<const std::size_t> rows, std::size_t n_folds) {
  const auto inputs = [&](std::size_t row) {
    const auto values = cases.inputs.row(static_cast<Eigen::Index>(row));
    return std::vector<double>(values.begin(), values.end());
  };
  std::map<std::vector<double>, std::vector<std::size_t>>
      groups;  // of equal inputs, whatever load they state
  for (const std::size_t row : rows) groups[inputs(row)].push_back(row);
  if (groups.size() < 2) return load_grouped_folds(cases.loads, rows, n_folds, rows.size());
  std::multimap<double, const std::vector<std::size_t>*> by_load;
  for (const auto& [values, group] : groups) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const std::size_t row : group) lowest = std::min(lowest, place_of(cases.loads[row]));
    by_load.emplace(lowest, &group);
  }
  Folds folds(possible_folds(n_folds, groups.size()));
  std::size_t i = 0;
  for (const auto& [load, group] : by_load) {
    auto& fold = folds[i++ % folds.size()];
    fold.insert(fold.end(), group->begin(), group->end());
  }
  for (auto& fold : folds) std::sort(fold.begin(), fold.end());
  return folds;
}

Folds joined(Folds folds, std::span<const double> loads, std::span<const std::size_t> more) {
  const auto known = folds;
  for (const std::size_t row : more) {
    const double load = place_of(loads[row]);
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < known.size(); ++k) {
      for (const std::size_t other : known[k]) {
        const double place = place_of(loads[other]);
        const double distance = place == load ? 0 : std::abs(place - load);
        if (distance < least) nearest = k, least = distance;
      }
    }
    folds[nearest].push_back(row);
  }
  for (auto& fold : folds) std::ranges::sort(fold);
  return folds;
}

Folds folds_of(std::span<const std::size_t> rows, std::span<const double> loads, const FitContext& context,
               const std::function<Folds(std::span<const std::size_t>)>& make) {
  const auto known = context.warm == nullptr ? std::vector<std::size_t>() : context.warm->known_among(rows);
  if (known.empty()) return make(rows);
  std::vector<std::size_t> more;
  std::ranges::set_difference(rows, known, std::back_inserter(more));
  return joined(make(known), loads, more);
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

MatrixF predict_by_fitting(const Method& method, const field::FieldData& data, const Folds& folds,
                           std::span<const std::size_t> wanted, const FitContext& context, bool parallel) {
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
  parallel = parallel && wanted.size() > 1;
  FitContext fold_context = context;
  if (parallel) fold_context.n_threads = 1;
  base::parallel_for(
      wanted.size(), parallel ? context.n_threads : 1,
      [&](std::size_t i, int) { one_fold(wanted[i], fold_context); }, context.stop);
  return predictions;
}

MatrixF Method::cross_predict(const field::FieldData& data, const Folds& folds,
                              const FitContext& context) const {
  return predict_folds(data, folds, math::all_rows(folds.size()), context);
}

MatrixF Method::predict_folds(const field::FieldData& data, const Folds& folds,
                              std::span<const std::size_t> wanted, const FitContext& context) const {
  return predict_by_fitting(*this, data, folds, wanted, context, false);
}

}  // namespace elrom::methods
