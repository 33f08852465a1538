#include "timing.hpp"

#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/io/file_kind.hpp"

namespace elrom::study {
namespace {

using Json = nlohmann::ordered_json;

Json parse_timing(const std::filesystem::path& path) {
  auto json = Json::parse(base::read_text(path), nullptr, false);
  io::check_json_kind(json, io::kinds::timing, path.string());
  return json;
}

/// A file that cannot be used must not stop the run whose time is to be written.
Json earlier_full_run(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return nullptr;
  try {
    return parse_timing(path).value("from_nothing", Json());
  } catch (const InputError&) {
    return nullptr;
  }
}

/// A number each, or an object with "seconds".
std::map<std::string, double> seconds_of(const Json& root, const char* part) {
  std::map<std::string, double> seconds;
  const auto entries = root.value(part, Json::object());  // outlives items(), which only refers to it
  for (const auto& [name, value] : entries.items()) {
    if (value.is_number()) seconds[name] = value.get<double>();
    if (value.is_object()) seconds[name] = value.at("seconds").get<double>();
  }
  return seconds;
}

}  // namespace

std::optional<StudyTiming> read_timing(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return std::nullopt;
  const auto json = parse_timing(path);
  try {
    StudyTiming timing{.total_seconds = json.value("total_seconds", 0.0),
                       .peak_rss_gib = json.value("peak_rss_gib", 0.0),
                       .stages = seconds_of(json, "stages"),
                       .methods = seconds_of(json, "methods")};
    timing.method_processor_seconds = seconds_of(json, "method_processor_seconds");
    timing.threads = json.value("threads", 1);
    timing.processor_seconds = json.value("processor_seconds", 0.0);
    const auto candidates = json.value("candidates", Json::object());
    for (const auto& [name, cost] : candidates.items())
      timing.candidates[name] = {cost.at("seconds").get<double>(),
                                 cost.at("processor_seconds").get<double>()};
    if (const auto full = json.value("from_nothing", Json()); full.is_object()) {
      timing.full_seconds = full.value("total_seconds", 0.0);
      timing.full_stages = seconds_of(full, "stages");
    }
    return timing;
  } catch (const Json::exception& fault) {
    throw InputError({.what = "no valid timing file", .where = path.string(), .found = fault.what()});
  }
}

double peak_rss_gib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
}

double processor_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

CostClock::CostClock(MethodCost& cost) : cost_(cost), processor_(processor_seconds()) {}

CostClock::~CostClock() {
  cost_.seconds += watch_.seconds();
  cost_.processor_seconds += processor_seconds() - processor_;
}

void write_timing(const std::filesystem::path& path,
                  const std::map<std::string, io::StageClock::Entry>& entries, double total_seconds,
                  int n_threads, const FitCosts& costs) {
  Json stages = Json::object();
  std::int64_t reused = 0;
  for (const auto& [stage, entry] : entries) {
    stages[stage] = {{"seconds", entry.seconds}, {"computed", entry.computed}, {"reused", entry.reused}};
    if (stage == "model") reused += entry.reused;  // within a run, models share what earlier stages kept
  }
  auto json = io::json_head<Json>(io::kinds::timing);
  json.update({{"threads", n_threads},
               {"total_seconds", total_seconds},
               {"processor_seconds", processor_seconds()},
               {"peak_rss_gib", peak_rss_gib()},
               {"stages", stages}});
  for (const auto& [method, seconds] : costs.methods)
    if (std::isfinite(seconds)) json["methods"][method] = seconds;
  for (const auto& [method, seconds] : costs.processor) json["method_processor_seconds"][method] = seconds;
  for (const auto& [name, cost] : costs.candidates)
    json["candidates"][name] = {{"seconds", cost.seconds}, {"processor_seconds", cost.processor_seconds}};
  json["from_nothing"] =
      reused == 0 ? Json{{"total_seconds", total_seconds}, {"stages", stages}} : earlier_full_run(path);
  base::write_text(path, json.dump(1) + "\n");
}

}  // namespace elrom::study
