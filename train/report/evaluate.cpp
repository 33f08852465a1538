// Scores every bundle of a study on the held-out cases, one field at a time so that memory stays flat.

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/report/accuracy.hpp"
#include "evaluate_bundles.hpp"
#include "evaluate_field.hpp"
#include "store_rows.hpp"

namespace elrom::report {
namespace {

void check_bundle(const model::BundleReader& bundle, const field::SnapshotStore& store) {
  if (bundle.mesh_digest() != store.mesh().digest())
    throw InputError({.what = "bundle and store are of different meshes",
                      .where = bundle.file().where(),
                      .found = bundle.mesh_digest().substr(0, 12),
                      .expected = store.mesh().digest().substr(0, 12) + " of " + store.path().string()});
  if (bundle.info().schema.names() != store.schema().names())
    throw InputError(
        {.what = "bundle and store have different boundary conditions", .where = bundle.file().where()});
}

// By name, or by the boundary conditions of a training case under another name.
std::vector<std::string> leaked_cases(const model::BundleReader& bundle, const field::SnapshotStore& store,
                                      const HeldOutCases& cases, const std::vector<std::string>& trained) {
  constexpr double same_inputs = 1e-9;  // distance in standardised inputs
  const auto guard = bundle.guard();
  std::vector<std::string> leaked;
  for (std::size_t i = 0; i < cases.scored.size(); ++i) {
    const auto& name = store.cases()[cases.scored[i]].inputs.name;
    const auto nearest = guard.assess(case_inputs(cases, i)).nearest;
    if (std::ranges::find(trained, name) != trained.end() ||
        (!nearest.empty() && nearest.front().distance < same_inputs))
      leaked.push_back(name);
  }
  return leaked;
}

// The study's split tells what is usual, or else its model.
void mark_other_cases(AccuracyReport& report) {
  const auto sorted = [](std::vector<std::string> names) {
    std::ranges::sort(names);
    return names;
  };
  const auto split = sorted(report.study.building);
  const auto has_split = [&](const MethodSummary& m) { return sorted(m.training_cases) == split; };
  const auto usual =
      std::ranges::any_of(report.methods, has_split) ? split : sorted(report.methods.front().training_cases);
  for (auto& method : report.methods) method.other_cases = sorted(method.training_cases) != usual;
}

// Opening and predicting all fields of one case, as a caller of the library would; the median of a few.
MethodSummary summarise(const BundleFile& file, const field::SnapshotStore& store, const HeldOutCases& cases,
                        int n_threads) {
  MethodSummary summary{.file = file};
  const base::Stopwatch opening;
  const model::Predictor predictor(file.path);
  summary.open_ms = 1e3 * opening.seconds();
  check_bundle(predictor.bundle(), store);
  summary.digest = predictor.bundle().digest();
  summary.training_cases = predictor.bundle().info().cases;
  summary.leaked_cases = leaked_cases(predictor.bundle(), store, cases, summary.training_cases);
  std::vector<float> values(predictor.size());
  model::Predictor::Scratch scratch;
  std::vector<double> times;
  for (int repeat = 0; repeat < 6; ++repeat) {
    const base::Stopwatch watch;
    predictor.predict(case_inputs(cases, 0), values, {}, scratch, n_threads);
    if (repeat > 0) times.push_back(1e3 * watch.seconds());
  }
  std::nth_element(times.begin(), times.begin() + 2, times.end());
  summary.predict_ms = times[2];
  return summary;
}

model::Audit audit_truth(const field::SnapshotStore& store, std::size_t row, std::span<const double> inputs) {
  const auto& fields = store.fields();
  std::vector<float> values;
  for (const auto& info : fields) {
    const auto cells = store.read(info.name, std::array{row});
    values.insert(values.end(), cells.data(), cells.data() + cells.size());
  }
  return model::audit({store.mesh(), store.schema(), inputs, fields, values},
                      model::audit_settings(store.furnace()));
}

// Validity verdict and physics audit of each scored case.
std::vector<ScoredCase> describe_cases(const field::SnapshotStore& store, const HeldOutCases& cases,
                                       const BundleFile& model, int n_threads) {
  const model::Predictor predictor(model.path);
  const auto guard = predictor.bundle().guard();
  std::vector<float> values(predictor.size());
  model::Predictor::Scratch scratch;
  std::vector<ScoredCase> described;
  for (std::size_t i = 0; i < cases.scored.size(); ++i) {
    const auto inputs = case_inputs(cases, i);
    const auto& record = store.cases()[cases.scored[i]];
    predictor.predict(inputs, values, {}, scratch, n_threads);
    described.push_back(
        {.name = record.inputs.name,
         .load = record.inputs.load,
         .validity = guard.assess(inputs),
         .truth_audit = audit_truth(store, cases.scored[i], inputs),
         .prediction_audit = model::audit({store.mesh(), store.schema(), inputs, predictor.fields(), values},
                                          model::audit_settings(store.furnace()))});
  }
  return described;
}

// An error below the noise has no score with the noise taken off, nor has a truth that departs from the mean
// by noise alone; such a field is left out for every method alike.
void average_over_fields(AccuracyReport& report) {
  for (std::size_t m = 0; m < report.methods.size(); ++m) {
    double sum = 0, clean = 0;
    int n_clean = 0;
    for (const auto& field : report.fields) {
      sum += field.nrmse(m);
      if (!field.above_noise()) continue;
      clean += field.nrmse_without_noise(m);
      ++n_clean;
    }
    report.methods[m].mean_nrmse = sum / static_cast<double>(report.fields.size());
    report.methods[m].mean_nrmse_without_noise = n_clean > 0 ? clean / n_clean : undefined;
  }
}

std::string now_utc() {
  return fmt::format("{:%Y-%m-%d %H:%M} UTC",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

}  // namespace

AccuracyReport evaluate(const AccuracyOptions& options, Log& log, const std::stop_token& stop) {
  auto study = open_study(options.study, options.store, options.cases);
  for (const auto& other : options.against) study.bundles.push_back(open_other(other));
  return evaluate_bundles(std::move(study), {options.n_threads, options.figures}, log, stop);
}

AccuracyReport evaluate_bundles(StudyFiles study, const EvaluateOptions& options, Log& log,
                                const std::stop_token& stop) {
  AccuracyReport report{.study = std::move(study), .created = now_utc()};
  const auto store = field::SnapshotStore::open(report.study.store);
  if (store.furnace())
    report.words = store.furnace()->words;
  else
    log.warning("no gas balance, and no case known as a repeated run: the store has no furnace description");
  const auto cases = hold_out_cases(store, report.study, log);
  report.n_training = cases.building.size();
  report.n_planes = store.mesh().n_planes;
  report.n_columns = store.mesh().n_columns;
  for (const auto& set : cases.repeats)
    for (const std::size_t row : set) report.repeats.push_back(store.cases()[row].inputs.name);
  for (std::size_t i = 0; i < cases.scored.size() && cases.all_repeated(); ++i)
    report.runs.push_back(cases.runs_of(i).size());
  const auto& bundles = report.study.bundles;
  for (const auto& bundle : bundles)
    report.methods.push_back(summarise(bundle, store, cases, options.n_threads));
  mark_other_cases(report);
  report.cases = describe_cases(store, cases, bundles.front(), options.n_threads);

  const auto fields = model::BundleReader(bundles.front().path).info().fields;
  if (options.figures)
    report.figures = start_figures(store.mesh(), bundles, fields.size(), cases.scored.size());
  for (std::size_t f = 0; f < fields.size(); ++f) {
    if (stop.stop_requested()) throw Interrupted("stopped before the report was complete");
    log.progress({.task = "score",
                  .done = static_cast<std::int64_t>(f),
                  .total = static_cast<std::int64_t>(fields.size()),
                  .unit = "fields"});
    report.fields.push_back(evaluate_field({store, cases, bundles, fields[f], options.n_threads},
                                           report.figures ? &*report.figures : nullptr));
  }
  log.progress({.task = "score",
                .done = static_cast<std::int64_t>(fields.size()),
                .total = static_cast<std::int64_t>(fields.size()),
                .unit = "fields"});
  average_over_fields(report);
  return report;
}

double FieldAccuracy::nrmse(std::size_t method) const {
  return methods[method].available ? methods[method].pooled.nrmse() : undefined;
}

double FieldAccuracy::noise_energy() const { return std::accumulate(noise.begin(), noise.end(), 0.0); }

std::optional<std::size_t> AccuracyReport::best_peer() const {
  std::optional<std::size_t> best;
  for (std::size_t m = 1; m < methods.size(); ++m)
    if (methods[m].file.is_peer && std::isfinite(methods[m].mean_nrmse) &&
        (!best || methods[m].mean_nrmse < methods[*best].mean_nrmse))
      best = m;
  return best;
}

std::optional<std::size_t> AccuracyReport::best_peer(const FieldAccuracy& field) const {
  std::optional<std::size_t> best;
  for (std::size_t m = 1; m < methods.size(); ++m)
    if (methods[m].file.is_peer && std::isfinite(field.nrmse(m)) &&
        (!best || field.nrmse(m) < field.nrmse(*best)))
      best = m;
  return best;
}

double AccuracyReport::mean_coverage(std::size_t i_level) const {
  double sum = 0;
  std::size_t n = 0;
  for (const auto& field : fields) {
    if (field.coverage.size() <= i_level) continue;
    for (const double share : field.coverage[i_level]) {
      if (!std::isfinite(share)) continue;
      sum += share;
      ++n;
    }
  }
  return n > 0 ? sum / static_cast<double>(n) : undefined;
}

}  // namespace elrom::report
