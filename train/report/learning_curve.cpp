#include "elrom/report/learning_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/report/metrics.hpp"
#include "elrom/report/study_files.hpp"
#include "elrom/study/settings.hpp"
#include "elrom/study/study.hpp"
#include "held_out_cases.hpp"
#include "refit.hpp"

namespace elrom::report {
namespace {

/// Cases of the study and of its held-out part, and the methods' view of them.
struct Material {
  field::SnapshotStore store;
  HeldOutCases rows;
  field::CaseSet cases;  //!< of `rows.building`
};

Material gather(const StudyFiles& study, Log& log) {
  Material material{field::SnapshotStore::open(study.store), {}, {}};
  material.rows = hold_out_cases(material.store, study, log);
  if (material.rows.building.size() < 4)
    throw UsageError("a learning curve needs at least four training cases");
  material.cases = study::study_cases(material.store, study::read_settings(study.settings),
                                      material.rows.building, silent_log());
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

/// What a fit is scored against.
struct Truths {
  MatrixF one_run;
  std::optional<AveragedTruth> averaged;
  TrainingStatistics statistics;
};

struct Scores {
  double one_run = 0;           // NRMSE
  double averaged = undefined;  // NRMSE^2, noise taken off
};

Scores score(const Material& material, const model::FieldModel& model, const Truths& truths) {
  model::Workspace workspace;
  std::vector<float> prediction(truths.statistics.cell_mean.size());
  ErrorSums sums, averaged;
  double noise = 0;
  for (std::size_t i = 0; i < material.rows.scored.size(); ++i) {
    methods::predict_case(model, case_inputs(material.rows, i), material.cases.mesh.n_planes, prediction,
                          workspace);
    const auto add = [&](const MatrixF& truth, ErrorSums& to) {
      to += error_sums({truth.row(static_cast<Eigen::Index>(i)).data(), prediction.size()}, prediction,
                       truths.statistics);
    };
    add(truths.one_run, sums);
    if (!truths.averaged) continue;
    add(truths.averaged->values, averaged);
    noise += truths.averaged->noise[i];
  }
  if (!truths.averaged) return {sums.nrmse(), undefined};
  return {sums.nrmse(), (averaged.error - noise) / (averaged.departure - noise)};
}

/// Noise of the kind that repeated runs show, for each training case: of the runs nearest in load their
/// departures from the mean, in random shares, so that its covariance is theirs. (n_cases, n_cells)
MatrixF noise_of_runs(const Material& material, const std::string& field, base::Random random) {
  const auto load_of = [&](std::size_t row) { return material.store.cases()[row].inputs.load; };
  std::vector<MatrixF> departures;
  for (const auto& runs : material.rows.repeats) {
    departures.push_back(material.store.read(field, runs));
    const Eigen::RowVectorXf mean = departures.back().colwise().mean();
    departures.back().rowwise() -= mean;
    departures.back() /= std::sqrt(static_cast<float>(runs.size() - 1));
  }
  MatrixF noise(static_cast<Eigen::Index>(material.rows.building.size()), departures.front().cols());
  for (Eigen::Index i = 0; i < noise.rows(); ++i) {
    std::size_t nearest = 0;
    const double load = load_of(material.rows.building[static_cast<std::size_t>(i)]);
    const auto distance = [&](std::size_t set) {
      return std::abs(load_of(material.rows.repeats[set].front()) - load);
    };
    for (std::size_t set = 1; set < departures.size(); ++set)
      if (distance(set) < distance(nearest)) nearest = set;
    Eigen::RowVectorXf shares(departures[nearest].rows());
    for (auto& share : shares) share = static_cast<float>(random.normal());
    noise.row(i) = shares * departures[nearest];
  }
  return noise;
}

/// Variances of the noise that training cases are given in all, in those that they have by themselves.
constexpr std::array noise_levels{1.0, 1.5, 2.0, 3.0};

/// How the fits of all fields are made and drawn.
struct Plan {
  const methods::Method& method;
  std::vector<std::size_t> sizes;
  std::vector<std::vector<std::size_t>> draws;
  methods::FitContext context;
  bool noise;
};

/// Of one field.
struct FieldErrors {
  MatrixD one_run, averaged;         // (sizes, draws)
  std::vector<double> noise_shares;  // NRMSE^2 against averaged truths, by noise_levels; empty: not known
};

void check_stop(const std::stop_token& stop) {
  if (stop.stop_requested()) throw Interrupted("stopped before the learning curve was complete");
}

// Fits to all cases with more noise than they have; that to the cases as they are is known already.
std::vector<double> with_noise(const Material& material, const Plan& plan, const field::FieldData& data,
                               const Truths& truths, double as_they_are) {
  std::vector<double> shares{as_they_are};
  const auto rows = math::all_rows(material.rows.building.size());
  for (std::size_t level = 1; level < noise_levels.size(); ++level) {
    double sum = 0;
    for (std::size_t d = 0; d < plan.draws.size(); ++d) {
      check_stop(plan.context.stop);
      auto noisy = data;
      noisy.values += static_cast<float>(std::sqrt(noise_levels[level] - 1)) *
                      noise_of_runs(material, data.info.name,
                                    base::Random(plan.context.seed.derive("noise").derive(level).derive(d)));
      sum += score(material, *plan.method.fit(noisy, rows, plan.context), truths).averaged;
    }
    shares.push_back(sum / static_cast<double>(plan.draws.size()));
  }
  return shares;
}

/// @param seconds processor time of the fits is added, (sizes, draws)
FieldErrors field_errors(const Material& material, const field::FieldInfo& info, const Plan& plan,
                         MatrixD& seconds) {
  const field::FieldData data{&material.cases, info, material.store.read(info.name, material.rows.building)};
  Truths truths{material.store.read(info.name, material.rows.scored),
                {},
                training_statistics(data.values, material.cases.mesh.n_columns)};
  if (material.rows.all_repeated())
    truths.averaged = averaged_truth(material.store, info.name, material.rows);
  FieldErrors errors{MatrixD(seconds.rows(), seconds.cols()), MatrixD(seconds.rows(), seconds.cols()), {}};
  for (Eigen::Index i = 0; i < seconds.rows(); ++i)
    for (Eigen::Index j = 0; j < seconds.cols(); ++j) {
      check_stop(plan.context.stop);
      const auto& order = plan.draws[static_cast<std::size_t>(j)];
      std::vector<std::size_t> rows(
          order.begin(),
          order.begin() + static_cast<std::ptrdiff_t>(plan.sizes[static_cast<std::size_t>(i)]));
      std::sort(rows.begin(), rows.end());
      const auto begin = std::clock();
      const auto model = plan.method.fit(data, rows, plan.context);
      seconds(i, j) += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      const auto scores = score(material, *model, truths);
      errors.one_run(i, j) = scores.one_run;
      errors.averaged(i, j) = scores.averaged;
    }
  if (truths.averaged && plan.noise)
    errors.noise_shares = with_noise(material, plan, data, truths, errors.averaged.bottomRows(1).mean());
  return errors;
}

/// Standard deviation; of one value 0.
double scatter(const Eigen::RowVectorXd& values) {
  const auto n = static_cast<double>(values.size());
  return n > 1 ? std::sqrt((values.array() - values.mean()).square().sum() / (n - 1)) : 0;
}

// Fields down, (sizes, draws) tables each, to points with mean and scatter over draws.
std::vector<LearningPoint> points_of(const std::vector<std::size_t>& sizes,
                                     const std::map<std::string, FieldErrors>& errors,
                                     const MatrixD& seconds) {
  std::vector<LearningPoint> points;
  const auto n_fields = static_cast<double>(errors.size());
  for (std::size_t s = 0; s < sizes.size(); ++s) {
    LearningPoint point{.cases = sizes[s]};
    const auto row = static_cast<Eigen::Index>(s);
    Eigen::RowVectorXd over_fields = Eigen::RowVectorXd::Zero(seconds.cols()), averaged = over_fields;
    for (const auto& [field, tables] : errors) {
      point.field_error[field] = tables.one_run.row(row).mean();
      over_fields += tables.one_run.row(row) / n_fields;
      averaged +=
          tables.averaged.row(row).unaryExpr([](double share) { return signed_nrmse(share, 1); }) / n_fields;
    }
    point.error_mean = over_fields.mean();
    point.error_std = scatter(over_fields);
    point.averaged_mean = averaged.mean();
    point.averaged_std = scatter(averaged);
    point.processor_seconds = seconds.row(row).mean();
    point.processor_spread = scatter(seconds.row(row));
    points.push_back(std::move(point));
  }
  return points;
}

AveragingCurve averaging_of(const std::map<std::string, FieldErrors>& errors) {
  if (errors.begin()->second.noise_shares.empty()) return {};
  std::vector<std::string> names;
  MatrixD shares(static_cast<Eigen::Index>(errors.size()), static_cast<Eigen::Index>(noise_levels.size()));
  for (const auto& [field, tables] : errors) {
    for (std::size_t level = 0; level < noise_levels.size(); ++level)
      shares(static_cast<Eigen::Index>(names.size()), static_cast<Eigen::Index>(level)) =
          tables.noise_shares[level];
    names.push_back(field);
  }
  return fit_averaging(names, {noise_levels.begin(), noise_levels.end()}, shares);
}

PowerLaw fit_points(const std::vector<LearningPoint>& points, double LearningPoint::*error) {
  std::vector<double> cases, errors;
  for (const auto& point : points) {
    cases.push_back(static_cast<double>(point.cases));
    errors.push_back(point.*error);
  }
  return fit_power_law(cases, errors);
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
  const auto n_cases = material.rows.building.size();
  const Plan plan{.method = *method,
                  .sizes = subset_sizes(n_cases, options.n_points),
                  .draws = orders(n_cases, std::max(1, options.n_repeats), base::Seed(options.seed)),
                  .context = {.seed = base::Seed(options.seed),
                              .n_threads = options.n_threads,
                              .log = &silent_log(),
                              .stop = stop},
                  .noise = options.noise};
  std::map<std::string, FieldErrors> errors;
  MatrixD seconds = MatrixD::Zero(static_cast<Eigen::Index>(plan.sizes.size()),
                                  static_cast<Eigen::Index>(plan.draws.size()));
  const auto tell = [&] {
    log.progress({.task = "learning curve",
                  .done = static_cast<std::int64_t>(errors.size()),
                  .total = static_cast<std::int64_t>(fields.size()),
                  .unit = "fields"});
  };
  for (const auto& info : fields) {
    tell();
    errors.emplace(info.name, field_errors(material, info, plan, seconds));
  }
  tell();
  curve.points = points_of(plan.sizes, errors, seconds);
  for (const auto& point : curve.points)
    if (point.cases == std::max<std::size_t>(4, n_cases / 3)) curve.v1 = point;
  curve.v2 = curve.points.back();
  curve.fit = fit_points(curve.points, &LearningPoint::error_mean);
  const auto n = static_cast<double>(n_cases);
  curve.gain_next_20 = curve.fit.at_bound() ? std::nan("") : 1 - curve.fit.at(n + 20) / curve.fit.at(n);
  if (curve.has_averaged_truth())
    curve.averaged_fit = fit_points(curve.points, &LearningPoint::averaged_mean);
  curve.averaging = averaging_of(errors);
  return curve;
}

}  // namespace elrom::report
