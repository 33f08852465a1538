#include "elrom/study/case_effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <nlohmann/json.hpp>

#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/study/scores.hpp"

namespace elrom::study {
namespace {

using Eigen::Index;
using Json = nlohmann::ordered_json;

/// One field of the cases that judge.
struct Bench {
  MatrixD inputs;
  MatrixF truth;
  double departure = 0;
  std::vector<std::size_t> own = {};  ///< place of each among the model's cases; empty: it has seen none
};

double squared_error(const model::FieldModel& model, const Bench& bench, Index i) {
  model::Workspace workspace;
  std::vector<float> values(static_cast<std::size_t>(bench.truth.cols()));
  methods::predict_case(model, {bench.inputs.row(i).data(), static_cast<std::size_t>(bench.inputs.cols())},
                        model.n_planes(), values, workspace);
  return math::squared_distance(values, {bench.truth.row(i).data(), values.size()});
}

/// NRMSE of the model; a judging case of its own is left out for its own sake.
double error_of(const model::FieldModel& model, const Bench& bench) {
  double sum = 0;
  for (Index i = 0; i < bench.truth.rows(); ++i)
    sum += bench.own.empty()
               ? squared_error(model, bench, i)
               : squared_error(*model.without_case(bench.own[static_cast<std::size_t>(i)]), bench, i);
  return math::nrmse(sum, bench.departure, 0);
}

Bench make_bench(const GateCases& cases, const std::string& field, const std::vector<std::size_t>& rows) {
  Bench bench{.inputs = cases.store.inputs(rows), .truth = cases.store.read(field, rows)};
  const auto statistics =
      training_statistics(cases.store.read(field, cases.building), cases.store.mesh().n_columns);
  for (Index i = 0; i < bench.truth.rows(); ++i) {
    const std::span<const float> truth(bench.truth.row(i).data(),
                                       static_cast<std::size_t>(bench.truth.cols()));
    bench.departure += error_sums(truth, truth, statistics).departure;
  }
  return bench;
}

/// Cases that judge: rows of the store and, where the model was trained on them, their places among its own.
void choose_judges(const GateCases& cases, const std::vector<std::string>& trained,
                   std::vector<std::size_t>& rows, std::vector<std::size_t>& own) {
  const auto name_of = [&](std::size_t row) { return cases.store.cases()[row].inputs.name; };
  const auto place = [&](std::size_t row) { return std::ranges::find(trained, name_of(row)); };
  rows = judged_cases(cases.store, cases.held_out).scored;
  std::erase_if(rows, [&](std::size_t row) { return place(row) != trained.end(); });
  if (!rows.empty()) return;
  for (const auto row : cases.building) {
    if (place(row) == trained.end()) continue;
    rows.push_back(row);
    own.push_back(static_cast<std::size_t>(place(row) - trained.begin()));
  }
}

}  // namespace

CaseEffects effects_of(const std::vector<std::string>& names, const std::filesystem::path& present,
                       const GateCases& cases, int n_threads) {
  const model::BundleReader reader(present);
  std::vector<std::size_t> rows, own, added;
  choose_judges(cases, reader.info().cases, rows, own);
  CaseEffects effects{.judged_on = own.empty() ? "held-out cases" : "leave-one-out"};
  for (const auto& name : names) {
    effects.cases.push_back({.name = name});
    added.push_back(cases.store.find(name).front());
  }
  const auto inputs = cases.store.inputs(added);
  const auto n_inputs = static_cast<std::size_t>(inputs.cols());
  std::size_t n_judged = 0;
  for (const auto& info : reader.info().fields) {
    const auto model = reader.model(info.name);
    if (rows.empty() || model->without_case(0) == nullptr) {
      effects.left_out.push_back(info.name);
      continue;
    }
    auto bench = make_bench(cases, info.name, rows);
    bench.own = own;
    const double without = error_of(*model, bench);
    const MatrixF values = cases.store.read(info.name, added);
    std::vector<double> with(names.size());
    base::parallel_for(names.size(), n_threads, [&](std::size_t i, int) {
      const auto row = static_cast<Index>(i);
      with[i] = error_of(*model::with_case(*model, {inputs.row(row).data(), n_inputs},
                                           {values.row(row).data(), static_cast<std::size_t>(values.cols())}),
                         bench);
    });
    for (std::size_t i = 0; i < names.size(); ++i) effects.cases[i].fields[info.name] = with[i] - without;
    ++n_judged;
  }
  if (n_judged == 0) effects.cases.clear();
  for (auto& one : effects.cases)
    for (const auto& [field, change] : one.fields) one.change += change / static_cast<double>(n_judged);
  std::ranges::stable_sort(effects.cases, std::greater<>{}, &CaseEffect::change);
  return effects;
}

std::string to_json(const CaseEffects& effects) {
  Json json{{"judged_on", effects.judged_on}, {"no_closed_form", effects.left_out}};
  json["cases"] = Json::array();
  for (const auto& one : effects.cases)
    json["cases"].push_back({{"case", one.name}, {"change", one.change}, {"fields", one.fields}});
  return json.dump();
}

std::string in_words(const CaseEffects& effects, double least) {
  std::string text;
  for (const auto& one : effects.cases) {
    if (!(one.change > least)) continue;
    const auto worst = std::ranges::max_element(
        one.fields, {}, [](const std::pair<const std::string, double>& field) { return field.second; });
    text +=
        fmt::format("{} hurts: the error is {} higher with it ({} {} most); train.exclude leaves it out\n",
                    one.name, base::rounded(one.change, 2), worst->first, base::rounded(worst->second, 2));
  }
  if (!effects.left_out.empty())
    text += "which new case helps or hurts is not told, for want of a closed form, for " +
            base::join(effects.left_out, ", ") + "\n";
  return text;
}

}  // namespace elrom::study
