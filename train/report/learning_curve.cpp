#include "elrom/report/learning_curve.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/report/metrics.hpp"
#include "elrom/report/study_files.hpp"
#include "elrom/study/settings.hpp"
#include "elrom/study/study.hpp"
#include "refit.hpp"
#include "store_rows.hpp"

namespace elrom::report {
namespace {

/// Cases of the study and of its held-out part, and the methods' view of them.
struct Material {
  field::SnapshotStore store;
  std::vector<std::size_t> building, scored;
  field::CaseSet cases;  //!< of `building`
};

Material gather(const StudyFiles& study, Log& log) {
  Material material{field::SnapshotStore::open(study.store), {}, {}, {}};
  material.building = learnt_rows(material.store, study.building, log);
  auto judges = study.held_out;
  std::erase_if(judges, [&](const std::string& name) {
    return material.store.furnace() && material.store.furnace()->is_repeat(name);
  });
  material.scored = judging_rows(material.store, judges);
  if (material.scored.empty() || material.building.size() < 4)
    throw UsageError("a learning curve needs at least four training cases and one held-out case");
  material.cases = study::study_cases(material.store, study::read_settings(study.settings), material.building,
                                      silent_log());
  return material;
}

// Sizes evenly spaced in the logarithm, with a third of the cases (v1) and all of them (v2) among them.
std::vector<std::size_t> subset_sizes(std::size_t n_cases, int n_points) {
  const double most = static_cast<double>(n_cases), least = std::max(4.0, most / 8);
  std::vector<std::size_t> sizes{std::max<std::size_t>(4, n_cases / 3), n_cases};
  for (int i = 0; i < n_points; ++i)
    sizes.push_back(static_cast<std::size_t>(std::lround(
        least * std::pow(most / least, n_points > 1 ? static_cast<double>(i) / (n_points - 1) : 1.0))));
  std::sort(sizes.begin(), sizes.end());
  sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
  return sizes;
}

// Nested draws: the first n of one random order.
std::vector<std::vector<std::size_t>> orders(std::size_t n_cases, int n_repeats, base::Seed seed) {
  std::vector<std::vector<std::size_t>> result;
  for (int i = 0; i < n_repeats; ++i) {
    auto& order = result.emplace_back(n_cases);
    std::iota(order.begin(), order.end(), std::size_t{0});
    base::Random random(seed.derive("learning-curve").derive(static_cast<std::uint64_t>(i)));
    random.shuffle(order);
  }
  return result;
}

double held_out_nrmse(const Material& material, const model::FieldModel& model, const MatrixF& truth,
                      const TrainingStatistics& statistics) {
  model::Workspace workspace;
  const auto inputs = material.store.inputs(material.scored);
  std::vector<float> prediction(statistics.cell_mean.size());
  ErrorSums sums;
  for (Eigen::Index i = 0; i < truth.rows(); ++i) {
    methods::predict_case(model, {inputs.row(i).data(), static_cast<std::size_t>(inputs.cols())},
                          material.cases.mesh.n_planes, prediction, workspace);
    sums += error_sums({truth.row(i).data(), prediction.size()}, prediction, statistics);
  }
  return sums.nrmse();
}

/// Errors of one field, (sizes, draws). @param seconds processor time of the fits is added, (sizes, draws)
MatrixD field_errors(const Material& material, const field::FieldInfo& info, const methods::Method& method,
                     const std::vector<std::size_t>& sizes,
                     const std::vector<std::vector<std::size_t>>& draws, const methods::FitContext& context,
                     MatrixD& seconds) {
  field::FieldData data{&material.cases, info, material.store.read(info.name, material.building)};
  const auto truth = material.store.read(info.name, material.scored);
  const auto statistics = training_statistics(data.values, material.cases.mesh.n_columns);
  MatrixD errors(static_cast<Eigen::Index>(sizes.size()), static_cast<Eigen::Index>(draws.size()));
  for (std::size_t s = 0; s < sizes.size(); ++s)
    for (std::size_t d = 0; d < draws.size(); ++d) {
      const auto i = static_cast<Eigen::Index>(s), j = static_cast<Eigen::Index>(d);
      if (context.stop.stop_requested()) throw Interrupted("stopped before the learning curve was complete");
      std::vector<std::size_t> rows(draws[d].begin(),
                                    draws[d].begin() + static_cast<std::ptrdiff_t>(sizes[s]));
      std::sort(rows.begin(), rows.end());
      const auto begin = std::clock();
      const auto model = method.fit(data, rows, context);
      seconds(i, j) += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      errors(i, j) = held_out_nrmse(material, *model, truth, statistics);
    }
  return errors;
}

/// Standard deviation; of one value 0.
double scatter(const Eigen::RowVectorXd& values) {
  const auto n = static_cast<double>(values.size());
  return n > 1 ? std::sqrt((values.array() - values.mean()).square().sum() / (n - 1)) : 0;
}

// Fields down, one (sizes, draws) table each, to points with mean and scatter over draws.
std::vector<LearningPoint> points_of(const std::vector<std::size_t>& sizes,
                                     const std::map<std::string, MatrixD>& errors, const MatrixD& seconds) {
  std::vector<LearningPoint> points;
  for (std::size_t s = 0; s < sizes.size(); ++s) {
    LearningPoint point{.cases = sizes[s]};
    const auto row = static_cast<Eigen::Index>(s);
    Eigen::RowVectorXd over_fields = Eigen::RowVectorXd::Zero(errors.begin()->second.cols());
    for (const auto& [field, table] : errors) {
      point.field_error[field] = table.row(row).mean();
      over_fields += table.row(row) / static_cast<double>(errors.size());
    }
    point.error_mean = over_fields.mean();
    point.error_std = scatter(over_fields);
    point.processor_seconds = seconds.row(row).mean();
    point.processor_spread = scatter(seconds.row(row));
    points.push_back(std::move(point));
  }
  return points;
}

}  // namespace

LearningCurve learning_curve(const LearningCurveOptions& options, Log& log, const std::stop_token& stop) {
  const auto study = open_study(options.study, options.store, options.cases);
  auto material = gather(study, log);
  const model::BundleReader bundle(study.bundles.front().path);
  const auto fields = options.fields.empty()
                          ? bundle.info().fields
                          : field::choose_fields(material.store.fields(), options.fields, "the store");
  LearningCurve curve{.study = study.name,
                      .method = options.method.empty() ? method_of(bundle) : options.method};
  const auto method = make_method(curve.method);
  if (is_simple_peer(curve.method)) material.cases.mirrors.clear();  // as a user would run it
  const auto sizes = subset_sizes(material.building.size(), options.n_points);
  const auto draws =
      orders(material.building.size(), std::max(1, options.n_repeats), base::Seed(options.seed));
  const methods::FitContext context{
      .seed = base::Seed(options.seed), .n_threads = options.n_threads, .log = &silent_log(), .stop = stop};
  std::map<std::string, MatrixD> errors;
  MatrixD seconds =
      MatrixD::Zero(static_cast<Eigen::Index>(sizes.size()), static_cast<Eigen::Index>(draws.size()));
  for (const auto& info : fields) {
    log.progress({.task = "learning curve",
                  .done = static_cast<std::int64_t>(errors.size()),
                  .total = static_cast<std::int64_t>(fields.size()),
                  .unit = "fields"});
    errors[info.name] = field_errors(material, info, *method, sizes, draws, context, seconds);
  }
  log.progress({.task = "learning curve",
                .done = static_cast<std::int64_t>(fields.size()),
                .total = static_cast<std::int64_t>(fields.size()),
                .unit = "fields"});
  curve.points = points_of(sizes, errors, seconds);
  std::vector<double> n, e;
  for (const auto& point : curve.points) {
    n.push_back(static_cast<double>(point.cases));
    e.push_back(point.error_mean);
    if (point.cases == std::max<std::size_t>(4, material.building.size() / 3)) curve.v1 = point;
  }
  curve.v2 = curve.points.back();
  curve.fit = fit_power_law(n, e);
  curve.gain_next_20 =
      curve.fit.at_bound() ? std::nan("") : 1 - curve.fit.at(n.back() + 20) / curve.fit.at(n.back());
  return curve;
}

}  // namespace elrom::report
