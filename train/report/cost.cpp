#include "elrom/report/cost.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/report/accuracy.hpp"
#include "names.hpp"

namespace elrom::report {
namespace {

using Json = nlohmann::ordered_json;

double training_time(const CostPoint& point) {
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
    point.front = std::isfinite(point.error) &&
                  std::none_of(points.begin(), points.end(),
                               [&](const CostPoint& other) { return beats(other, point); });
}

CostReport cost_report(const CostOptions& options, Log& log, const std::stop_token& stop) {
  if (options.studies.empty()) throw UsageError("no study to report on; name at least one study directory");
  CostReport report;
  for (const auto& study : options.studies) {
    const auto accuracy =
        evaluate({.study = study, .store = options.store, .n_threads = options.n_threads}, log, stop);
    for (std::size_t m = 0; m < accuracy.methods.size(); ++m) {
      if (m > 0 && !options.peers) break;
      const auto& method = accuracy.methods[m];
      report.points.push_back(
          {.name = m == 0 ? accuracy.study.name : accuracy.study.name + ": " + method.file.name,
           .error = method.mean_nrmse,
           .train_seconds = method.file.train_seconds,
           .predict_ms = method.open_ms + method.predict_ms});
    }
  }
  mark_front(report.points);
  return report;
}

std::string to_json(const CostReport& report) {
  auto root = io::json_head<Json>(io::kinds::cost);
  root["points"] = Json::array();
  for (const auto& point : report.points)
    root["points"].push_back({{"name", point.name},
                              {"error", std::isfinite(point.error) ? Json(point.error) : Json()},
                              {"train_seconds", point.train_seconds ? Json(*point.train_seconds) : Json()},
                              {"predict_ms", point.predict_ms},
                              {"front", point.front}});
  return root.dump(1) + '\n';
}

CostReport read_cost_report(const std::filesystem::path& path) {
  const auto root = Json::parse(base::read_text(path), nullptr, false);
  io::check_json_kind(root, io::kinds::cost, path.string());
  try {
    CostReport report;
    for (const auto& node : root.at("points")) {
      CostPoint point{
          .name = node.at("name"), .predict_ms = node.at("predict_ms"), .front = node.at("front")};
      point.error = node.at("error").is_null() ? std::numeric_limits<double>::quiet_NaN()
                                               : node.at("error").get<double>();
      if (!node.at("train_seconds").is_null()) point.train_seconds = node.at("train_seconds").get<double>();
      report.points.push_back(std::move(point));
    }
    return report;
  } catch (const Json::exception& fault) {
    throw InputError({.what = "not a cost report", .where = path.string(), .found = fault.what()});
  }
}

std::string terminal_table(const CostReport& report) {
  std::size_t width = 12;
  for (const auto& point : report.points) width = std::max(width, point.name.size());
  auto text = fmt::format("\n  {:<{}}  {:>8}  {:>9}  {:>14}  {:>11}\n", "what", width, "error", "change",
                          "training", "prediction");
  text += "  " + std::string(width + 50, '-') + '\n';
  for (const auto& point : report.points) {
    const double change = point.error / report.points.front().error - 1;
    text += fmt::format("  {:<{}}  {:>8}  {:>9}  {:>14}  {:>8.1f} ms{}\n", point.name, width,
                        score_text(point.error, 4),
                        &point == &report.points.front() ? "" : fmt::format("{:+.1f} %", 100 * change),
                        point.train_seconds ? base::duration(*point.train_seconds) : "not kept",
                        point.predict_ms, point.front ? "  *" : "");
  }
  return text +
         "\n  error: mean NRMSE over fields on the held-out cases; change: against the first line\n"
         "  * no other is at least as good in error, training and prediction, and better in one\n";
}

}  // namespace elrom::report
