#include "elrom/study/budget.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/kernel_method.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/study.hpp"
#include "elrom/study/timing.hpp"
#include "field_stage.hpp"

namespace elrom::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr int fewest_folds = 2, some_folds = 4;
constexpr double peers_beside = 4;  // a run with the simple peers, as a multiple of one with the kernel alone
constexpr double standard_networks = 3;  // effort "standard" as a multiple of "quick", of networks alone
constexpr double margin = 0.85;          // share of the time that is planned with: other work comes and goes
constexpr double hope = 2;    // of the cheapest that is left: what it makes is kept for a later run
constexpr double sure = 0.5;  // of a level that nothing stands in for when it is not done

constexpr double for_a_simple_peer = 0.07;  // share of the time kept back while there is no model at all

/// Asks to stop when the time is up, or when somebody else asks.
class Deadline {
 public:
  Deadline(double seconds, const std::stop_token& outer)
      : passes_on_(outer, [this] { source_.request_stop(); }),
        timer_([this, seconds](const std::stop_token& done) {
          std::mutex mutex;
          std::unique_lock lock(mutex);
          std::condition_variable_any never;
          never.wait_for(lock, done, std::chrono::duration<double>(seconds), [] { return false; });
          if (!done.stop_requested()) source_.request_stop();
        }) {}
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::stop_callback<std::function<void()>> passes_on_;
  std::jthread timer_;
};

/// The kernel's fit of one field on all training cases, on one thread.
double calibrate(const field::SnapshotStore& store, const Settings& settings, const std::string& field,
                 const std::vector<std::size_t>& rows, Log& log) {
  const auto cases = study_cases(store, settings, rows, log);
  const auto& fields = store.fields();
  const auto info = std::ranges::find(fields, field, &field::FieldInfo::name);
  const field::FieldData data{&cases, *info, store.read(field, rows)};
  const auto kernel = methods::make_kernel_method();
  const base::Stopwatch watch;
  (void)kernel->fit(data, math::all_rows(cases.n_cases()), {});
  return watch.seconds();
}

void read_earlier_run(CostModel& model, const std::filesystem::path& folder) {
  const auto bundle = folder / "model.elrom";
  if (!std::filesystem::exists(bundle)) return;
  const auto accuracy = Json::parse(model::BundleReader(bundle).info().accuracy_json, nullptr, false);
  int tried = 0, used = 0;
  for (const auto& [field, entry] : accuracy.items()) {
    const auto candidates = entry.value("candidates", Json::array());
    for (const auto& candidate : candidates) {
      if (candidate.value("name", "") != "networks") continue;
      ++tried;
      used += candidate.value("weight", 0.0) > 0 ? 1 : 0;
    }
  }
  model.networks_had_no_part = tried > 0 && used == 0;
  const auto timing = read_timing(folder / "timing.json");
  if (!timing) return;
  const auto networks = timing->candidates.find("networks");
  double others = 0;
  for (const auto& [name, cost] : timing->candidates)
    if (name != "networks") others += cost.processor_seconds;
  if (networks != timing->candidates.end() && others > 0)
    model.networks = 1 + networks->second.processor_seconds / others;
}

/// Fits of one method a field: the model's, those of the contest and those of the intervals.
double seconds_without_networks(const CostModel& model, int folds, bool with_peers) {
  const auto n_folds = static_cast<std::size_t>(folds), threads = static_cast<std::size_t>(model.n_threads);
  const auto turns = [&](std::size_t n) {
    return static_cast<double>(n) / static_cast<double>(std::clamp<std::size_t>(n, 1, threads));
  };
  const double fits = 1 + turns(n_folds) + turns(interval_folds(n_folds, model.n_cases));
  return model.seconds_per_fit * static_cast<double>(model.n_fields) * fits * (with_peers ? peers_beside : 1);
}

Settings without_networks(Settings settings, int folds, bool with_peers) {
  settings.peers.networks = false;
  settings.peers.folds = std::min(settings.peers.folds, folds);
  if (!with_peers) settings.peers.methods.clear();
  return settings;
}

/// What takes next to nothing, and stands in where nothing else is done.
Settings simple_peer(const Settings& settings) {
  auto simple = without_networks(settings, fewest_folds, false);
  simple.method = "pod_rbf";
  return simple;
}

}  // namespace

CostModel cost_model(const std::filesystem::path& folder, const Settings& settings, Log& log) {
  const std::filesystem::path named(settings.store);
  const auto store = field::SnapshotStore::open(named.is_absolute() ? named : folder / named);
  const auto fields = field::choose_fields(store.fields(), settings.fields, "fields.names");
  const auto rows = hold_out(store, held_out_patterns(store, settings, log)).building;
  CostModel model{.n_fields = fields.size(), .n_cases = rows.size(), .n_threads = settings.n_threads()};
  read_earlier_run(model, folder);
  model.seconds_per_fit = calibrate(store, settings, fields.front().name, rows, log);
  return model;
}

std::vector<BudgetLevel> budget_levels(const Settings& settings, const CostModel& model) {
  if (settings.method != "auto") return {{settings.method + " as asked", settings, 0, "what was asked for"}};
  std::vector<BudgetLevel> levels{{"POD + RBF", simple_peer(settings), 0, "a model"}};
  const auto add = [&](const std::string& name, int folds, bool with_peers, const std::string& buys) {
    const auto own = without_networks(settings, folds, with_peers);
    levels.push_back({fmt::format("{}, {} folds", name, own.peers.folds), own,
                      seconds_without_networks(model, own.peers.folds, with_peers), buys});
  };
  add("kernel alone", fewest_folds, false, "most often a lower error than that of POD + RBF");
  add("kernel alone", some_folds, false, "intervals and errors from models that miss fewer cases");
  add("kernel and simple peers", some_folds, true,
      "a peer that beats the kernel on some field would be found");
  add("kernel and simple peers", settings.peers.folds, true,
      "intervals and errors from models that miss fewer cases");
  if (!settings.peers.networks) return levels;
  const double multiple =
      settings.effort == "quick" ? model.networks : 1 + standard_networks * (model.networks - 1);
  levels.push_back(
      {fmt::format("networks too, effort {}", settings.effort), settings, levels.back().seconds * multiple,
       model.networks_had_no_part
           ? "they had no part in the present model, which tried them: expect nothing of it"
           : "on the shipped cases they cost as much as the rest or more, and lower the mean error by less than "
             "1 %"});
  return levels;
}

std::optional<std::size_t> next_level(const std::vector<BudgetLevel>& levels, double seconds,
                                      const BudgetRun& run) {
  const double share = run.done ? margin : sure;
  std::optional<std::size_t> next;
  for (std::size_t i = run.done ? *run.done + 1 : 0; i < levels.size(); ++i) {
    const bool needs_a_model = levels[i].settings.method == "auto" && levels[i].settings.peers.networks;
    if (needs_a_model && (!run.done || next)) continue;
    if (levels[i].seconds * run.pace <= share * seconds) next = i;
  }
  if (next || !run.done || *run.done + 1 == levels.size()) return next;
  const auto cheapest = *run.done + 1;
  return levels[cheapest].seconds * run.pace <= hope * seconds ? std::optional(cheapest) : std::nullopt;
}

std::vector<std::string> left_out(const std::vector<BudgetLevel>& levels, const BudgetRun& run) {
  std::vector<std::string> words;
  for (std::size_t i = run.done ? *run.done + 1 : 0; i < levels.size(); ++i) {
    const auto& level = levels[i];
    const auto time = level.seconds > 0 ? " (about " + base::duration(level.seconds * run.pace) + ")" : "";
    words.push_back(fmt::format("left out: {}{}; {}", level.name, time, level.buys));
  }
  const auto& last = levels.back().settings;
  const bool can_search = last.peers.networks && last.effort != "thorough";
  if (words.empty())
    words.push_back(fmt::format("nothing was left out at effort {}: more time buys nothing{}; more cases do",
                                last.effort,
                                can_search ? " but a longer search for networks (a higher effort)" : ""));
  return words;
}

BudgetRun run_within(double seconds, const std::vector<BudgetLevel>& levels, Log& log,
                     const std::stop_token& stop,
                     const std::function<void(const Settings&, std::stop_token)>& train) {
  check(!levels.empty(), "run_within: a level");
  const base::Stopwatch watch;
  BudgetRun run;
  while (const auto next = next_level(levels, seconds - watch.seconds(), run)) {
    const auto& level = levels[*next];
    log.info(fmt::format("planned: {} (about {})", level.name, base::duration(level.seconds * run.pace)));
    const double kept_back = run.done ? 0 : for_a_simple_peer;
    const base::Stopwatch level_watch;
    const Deadline deadline((1 - kept_back) * seconds - watch.seconds(), stop);
    try {
      train(level.settings, deadline.token());
    } catch (const Interrupted&) {
      if (stop.stop_requested()) throw;
      log.warning(fmt::format("the time is up before '{}' is done", level.name));
      if (run.done) return run;
      run.settings = simple_peer(level.settings);
      train(run.settings, stop);
      return run;
    }
    run.done = next;
    run.settings = level.settings;
    if (level.seconds > 0) run.pace = level_watch.seconds() / level.seconds;
  }
  return run;
}

}  // namespace elrom::study
