#include "elrom/report/cost.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/predictor.hpp"
#include "elrom/report/accuracy.hpp"
#include "elrom/report/learning_curve.hpp"
#include "elrom/study/timing.hpp"
#include "refit.hpp"

namespace elrom::report {
namespace {

using Json = nlohmann::ordered_json;

double training_time(const CostPoint& point) {
  if (point.train_processor_seconds) return *point.train_processor_seconds;
  return point.train_seconds.value_or(std::numeric_limits<double>::infinity());
}

bool beats(const CostPoint& a, const CostPoint& b) {
  const bool no_worse =
      a.error <= b.error && training_time(a) <= training_time(b) && a.predict_ms <= b.predict_ms;
  const bool better = a.error < b.error || training_time(a) < training_time(b) || a.predict_ms < b.predict_ms;
  return no_worse && better;
}

}  // namespace

void mark_front(std::vector<CostPoint>& points) {
  for (auto& point : points)
    point.front = std::isfinite(point.error) && std::isfinite(point.predict_ms) &&
                  std::none_of(points.begin(), points.end(),
                               [&](const CostPoint& other) { return beats(other, point); });
}

namespace {

double thread_milliseconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

/// Opening and all fields of one case, on one thread.
void time_prediction(CostPoint& point, const std::filesystem::path& bundle, std::span<const double> inputs) {
  constexpr int repeats = 7;
  std::vector<double> times;
  for (int i = 0; i <= repeats; ++i) {
    const double begin = thread_milliseconds();
    const model::Predictor predictor(bundle);
    std::vector<float> values(predictor.size());
    model::Predictor::Scratch scratch;
    predictor.predict(inputs, values, {}, scratch);
    if (i > 0) times.push_back(thread_milliseconds() - begin);  // the first reads the file
  }
  point.predict_ms = math::median(times);
  point.predict_spread_ms = math::robust_deviation(times);
}

/// Of the mean over fields, each case left out in turn (Efron & Tibshirani 1993, eq. 11.5).
double jackknife_deviation(const AccuracyReport& accuracy, std::size_t method) {
  const auto n = accuracy.cases.size();
  std::vector<double> means;
  for (std::size_t left = 0; left < n; ++left) {
    double mean = 0;
    for (const auto& field : accuracy.fields) {
      const auto& scores = field.methods[method];
      if (!scores.available || scores.cases.size() != n) return 0;
      ErrorSums sums;
      for (std::size_t i = 0; i < n; ++i)
        if (i != left) sums += scores.cases[i];
      mean += sums.nrmse() / static_cast<double>(accuracy.fields.size());
    }
    means.push_back(mean);
  }
  if (n < 2) return 0;
  const double centre = std::accumulate(means.begin(), means.end(), 0.0) / static_cast<double>(n);
  double squares = 0;
  for (const double mean : means) squares += (mean - centre) * (mean - centre);
  return std::sqrt(squares * static_cast<double>(n - 1) / static_cast<double>(n));
}

/// In how many fields a method was tried, and in how many it has a weight.
void count_fields(PartCost& part, const std::string& accuracy_json) {
  const auto accuracy = Json::parse(accuracy_json, nullptr, false);
  if (!accuracy.is_object()) return;
  for (const auto& [field, entry] : accuracy.items()) {
    const auto candidates = entry.value("candidates", Json::array());
    for (const auto& candidate : candidates) {
      if (candidate.value("name", "") != part.method || candidate.contains("cases")) continue;
      ++part.fields;
      part.fields_used += candidate.value("weight", 0.0) > 0 ? 1 : 0;
    }
  }
}

double scatter_of(const AccuracyReport& accuracy) {
  double sum = 0;
  for (const auto& field : accuracy.fields) {
    const double departure = field.methods.front().pooled.departure;
    if (!(field.noise_energy() > 0 && departure > 0)) return 0;
    sum += std::sqrt(field.noise_energy() / departure) / static_cast<double>(accuracy.fields.size());
  }
  return sum;
}

std::vector<PartCost> parts_of(const AccuracyReport& accuracy, const study::StudyTiming& timing) {
  const auto json = model::BundleReader(accuracy.methods.front().file.path).info().accuracy_json;
  std::vector<PartCost> parts;
  for (const auto& [name, cost] : timing.candidates) {
    PartCost part{.study = accuracy.study.name,
                  .method = name,
                  .processor_seconds = cost.processor_seconds,
                  .error = std::nan("")};
    count_fields(part, json);
    for (const auto& method : accuracy.methods)
      if (method.file.name == name) part.error = method.mean_nrmse;
    parts.push_back(std::move(part));
  }
  return parts;
}

}  // namespace

void add_points(CostReport& report, const AccuracyReport& accuracy, bool peers) {
  const auto timing =
      study::read_timing(accuracy.study.directory / "timing.json").value_or(study::StudyTiming());
  const auto store = field::SnapshotStore::open(accuracy.study.store);
  const auto row = store.find(accuracy.cases.front().name);
  const MatrixD inputs = store.inputs(row);
  const auto processor = [&](const std::string& name, bool main) -> std::optional<double> {
    const auto found = timing.method_processor_seconds.find(name);
    if (found == timing.method_processor_seconds.end()) return std::nullopt;
    // Networks of a bundle of their own reuse what the model's choice made of them, and so owe it.
    const auto made = timing.candidates.find("networks");
    const bool owes = !main && name == "networks" && made != timing.candidates.end();
    return found->second + (owes ? made->second.processor_seconds : 0);
  };
  for (std::size_t m = 0; m < accuracy.methods.size(); ++m) {
    if (m > 0 && !peers) break;
    const auto& method = accuracy.methods[m];
    const auto own = m == 0 ? model::BundleReader(method.file.path).info().method : method.file.name;
    CostPoint point{.name = m == 0 ? accuracy.study.name : accuracy.study.name + ": " + method.file.name,
                    .error = method.mean_nrmse,
                    .train_seconds = method.file.train_seconds};
    point.error_deviation = jackknife_deviation(accuracy, m);
    point.train_processor_seconds = processor(own, m == 0);
    time_prediction(point, method.file.path, {inputs.row(0).data(), static_cast<std::size_t>(inputs.cols())});
    report.points.push_back(std::move(point));
  }
  const auto parts = parts_of(accuracy, timing);
  // The same model, had nothing been tried but what it is made of.
  CostPoint bare = report.points[report.points.size() - (peers ? accuracy.methods.size() : 1)];
  double needed = 0, all = 0;
  std::string names;
  for (const auto& part : parts) {
    all += part.processor_seconds;
    if (part.fields_used == 0) continue;
    needed += part.processor_seconds;
    names += (names.empty() ? "" : " + ") + part.method;
  }
  if (needed > 0 && needed < 0.98 * all) {
    bare.name += ": " + names + " alone";
    bare.train_processor_seconds = needed;
    bare.train_seconds =
        bare.train_seconds ? std::optional(*bare.train_seconds * needed / all) : std::nullopt;
    report.points.push_back(std::move(bare));
  }
  report.parts.insert(report.parts.end(), parts.begin(), parts.end());
  if (report.reference.n_cases == 0) {
    report.reference.n_cases = static_cast<double>(accuracy.n_training);
    report.reference.error = scatter_of(accuracy);
  }
  mark_front(report.points);
}

void add_sizes(CostReport& report, const CostOptions& options, Log& log, const std::stop_token& stop) {
  for (const auto& method : refittable_methods()) {
    const auto curve = learning_curve({.study = options.studies.front(),
                                       .store = options.store,
                                       .cases = options.cases,
                                       .method = method,
                                       .n_points = 2,  // and a third of the cases
                                       .n_threads = options.n_threads,
                                       .noise = false},
                                      log, stop);
    for (const auto& fitted : curve.points) {
      CostPoint point{.name = fmt::format("{}: {}, {} cases", curve.study, method, fitted.cases),
                      .error = fitted.error_mean,
                      .predict_ms = std::nan("")};
      point.error_deviation = fitted.error_std;
      point.train_processor_seconds = fitted.processor_seconds;
      point.train_spread_seconds = fitted.processor_spread;
      point.cases = fitted.cases;
      report.points.push_back(std::move(point));
    }
  }
}

CostReport cost_report(const CostOptions& options, Log& log, const std::stop_token& stop) {
  if (options.studies.empty()) throw UsageError("no study to report on; name at least one study directory");
  CostReport report{.points = {}, .reference = options.reference, .parts = {}};
  for (const auto& study : options.studies)
    add_points(
        report,
        evaluate(
            {.study = study, .store = options.store, .cases = options.cases, .n_threads = options.n_threads},
            log, stop),
        options.peers);
  if (options.sizes) add_sizes(report, options, log, stop);
  return report;
}

std::string to_json(const CostReport& report) {
  auto root = io::json_head<Json>(io::kinds::cost);
  root["points"] = Json::array();
  for (const auto& point : report.points)
    root["points"].push_back(
        {{"name", point.name},
         {"error", std::isfinite(point.error) ? Json(point.error) : Json()},
         {"train_seconds", point.train_seconds ? Json(*point.train_seconds) : Json()},
         {"predict_ms", std::isfinite(point.predict_ms) ? Json(point.predict_ms) : Json()},
         {"front", point.front},
         {"error_deviation", point.error_deviation},
         {"train_processor_seconds",
          point.train_processor_seconds ? Json(*point.train_processor_seconds) : Json()},
         {"predict_spread_ms", point.predict_spread_ms},
         {"cases", point.cases},
         {"train_spread_seconds", point.train_spread_seconds}});
  const auto& reference = report.reference;
  root["reference"] = {{"name", reference.name},
                       {"hours", reference.hours},
                       {"cores", reference.cores},
                       {"error", reference.error},
                       {"training_cases", reference.n_cases}};
  root["parts"] = Json::array();
  for (const auto& part : report.parts)
    root["parts"].push_back({{"study", part.study},
                             {"method", part.method},
                             {"processor_seconds", part.processor_seconds},
                             {"fields", part.fields},
                             {"fields_used", part.fields_used},
                             {"error", std::isfinite(part.error) ? Json(part.error) : Json()}});
  root["words"] = in_words(report);
  return root.dump(1) + '\n';
}

CostReport read_cost_report(const std::filesystem::path& path) {
  const auto root = Json::parse(base::read_text(path), nullptr, false);
  io::check_json_kind(root, io::kinds::cost, path.string());
  try {
    CostReport report;
    for (const auto& node : root.at("points")) {
      CostPoint point{.name = node.at("name"), .front = node.at("front")};
      point.predict_ms = node.at("predict_ms").is_null() ? std::nan("") : node.at("predict_ms").get<double>();
      point.cases = node.value("cases", std::size_t{0});
      point.train_spread_seconds = node.value("train_spread_seconds", 0.0);
      point.error = node.at("error").is_null() ? std::numeric_limits<double>::quiet_NaN()
                                               : node.at("error").get<double>();
      if (!node.at("train_seconds").is_null()) point.train_seconds = node.at("train_seconds").get<double>();
      point.error_deviation = node.value("error_deviation", 0.0);
      point.predict_spread_ms = node.value("predict_spread_ms", 0.0);
      if (const auto seconds = node.value("train_processor_seconds", Json()); seconds.is_number())
        point.train_processor_seconds = seconds.get<double>();
      report.points.push_back(std::move(point));
    }
    const auto reference = root.value("reference", Json::object());
    report.reference = {.name = reference.value("name", "CFD"),
                        .hours = reference.value("hours", 0.0),
                        .cores = reference.value("cores", 1.0),
                        .error = reference.value("error", 0.0),
                        .n_cases = reference.value("training_cases", 0.0)};
    const auto parts = root.value("parts", Json::array());
    for (const auto& node : parts)
      report.parts.push_back(
          {.study = node.at("study"),
           .method = node.at("method"),
           .processor_seconds = node.at("processor_seconds"),
           .fields = node.at("fields"),
           .fields_used = node.at("fields_used"),
           .error = node.at("error").is_number() ? node.at("error").get<double>() : std::nan("")});
    return report;
  } catch (const Json::exception& fault) {
    throw InputError({.what = "not a cost report", .where = path.string(), .found = fault.what()});
  }
}

}  // namespace elrom::report
