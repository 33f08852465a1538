#include "timing.hpp"

#include <sys/resource.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/version.hpp"

namespace elrom::study {
namespace {

nlohmann::ordered_json earlier_full_run(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) return nullptr;
  const auto json = nlohmann::ordered_json::parse(base::read_text(path), nullptr, false);
  return json.is_object() && json.contains("from_nothing") ? json["from_nothing"] : nlohmann::ordered_json();
}

}  // namespace

double peak_rss_gib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0);
}

void write_timing(const std::filesystem::path& path,
                  const std::map<std::string, io::StageClock::Entry>& entries, double total_seconds,
                  int n_threads, const std::map<std::string, double>& methods) {
  nlohmann::ordered_json stages = nlohmann::ordered_json::object();
  std::int64_t reused = 0;
  for (const auto& [stage, entry] : entries) {
    stages[stage] = {{"seconds", entry.seconds}, {"computed", entry.computed}, {"reused", entry.reused}};
    if (stage == "model") reused += entry.reused;  // within a run, models share what earlier stages kept
  }
  nlohmann::ordered_json json{{"kind", "elrom-timing"},
                              {"format", {1, 0}},
                              {"program", program_version()},
                              {"threads", n_threads},
                              {"total_seconds", total_seconds},
                              {"peak_rss_gib", peak_rss_gib()},
                              {"stages", stages}};
  for (const auto& [method, seconds] : methods)
    if (std::isfinite(seconds)) json["methods"][method] = seconds;
  json["from_nothing"] = reused == 0
                             ? nlohmann::ordered_json{{"total_seconds", total_seconds}, {"stages", stages}}
                             : earlier_full_run(path);
  base::write_text(path, json.dump(1) + "\n");
}

}  // namespace elrom::study
