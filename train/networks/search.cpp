#include "elrom/networks/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "elrom/base/error.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "proposals.hpp"

namespace elrom::networks {
namespace {

using Row = TrialOf<NamedValues>;

constexpr int eta = 3;
constexpr std::size_t never_pruned = 8;  // the first trials show what can be reached
constexpr double nearly = 1.1;           // times the best error: about what seeds differ by

double finite(double value) {
  return value < worst_value ? std::max(value, 0.0) : worst_value;
}  // NaN: the worst

// A diverged trial is worse than every other, and the worse the higher its rate: a local algorithm that
// begins among diverging rates finds its way out.
double diverged_value(const NamedValues& hyperparameters) {
  const auto named = std::ranges::find(hyperparameters, "learning_rate", &NamedValue::name);
  if (named == hyperparameters.end()) return worst_value;
  const double rate = std::get<double>(named->value);
  return worst_value * (0.5 + 0.5 * rate / (1 + rate));
}

// Asynchronous successive halving: a trial goes on at a rung while it is among the best third seen there.
class Halving {
 public:
  explicit Halving(int max_epochs) {
    for (int rung = max_epochs / (eta * eta); rung < max_epochs; rung *= eta) {
      if (rung > 0)
        epochs_.push_back(rung);
      else
        break;
    }
    seen_.resize(epochs_.size());
  }
  [[nodiscard]] const std::vector<int>& epochs() const { return epochs_; }
  [[nodiscard]] bool hopeless(std::size_t rung, double value, std::size_t n_trials) const {
    if (n_trials < never_pruned) return false;
    const auto better = std::ranges::count_if(seen_[rung], [&](double other) { return other < value; });
    return static_cast<std::size_t>(better) * eta >= seen_[rung].size() + 1;
  }
  void record(const std::vector<double>& rungs) {
    for (std::size_t r = 0; r < std::min(rungs.size(), seen_.size()); ++r) seen_[r].push_back(rungs[r]);
  }

 private:
  std::vector<int> epochs_;
  std::vector<std::vector<double>> seen_;
};

class RungMonitor final : public TrainingMonitor {
 public:
  RungMonitor(const Halving& halving, std::size_t n_trials, bool prune)
      : halving_(halving), n_trials_(n_trials), prune_(prune) {}
  bool keep_going(int epoch, double validation_mse) override {
    best_ = std::min(best_, finite(validation_mse));
    const auto& rungs = halving_.epochs();
    const auto rung = std::ranges::find(rungs, epoch);
    if (rung == rungs.end()) return true;
    reached_.push_back(best_);
    return !prune_ || !halving_.hopeless(static_cast<std::size_t>(rung - rungs.begin()), best_, n_trials_);
  }
  [[nodiscard]] const std::vector<double>& reached() const { return reached_; }
  [[nodiscard]] double best() const { return best_; }

 private:
  const Halving& halving_;
  std::size_t n_trials_;
  bool prune_;
  double best_ = worst_value;
  std::vector<double> reached_;
};

class Searcher {
 public:
  explicit Searcher(const ValueSearch& search) : search_(search), halving_(search.max_epochs) {}

  SearchResultOf<NamedValues> run() {
    const auto n_trials = static_cast<std::size_t>(search_.trials);
    progress();
    propose(search_.algorithm, search_.space->n_dimensions(), search_.space->initial_step(), n_trials,
            search_.seed.derive("propose"), [this](std::span<const double> point) { return ask(point); });
    confirm();
    tell_lost();
    return std::move(result_);
  }

 private:
  double ask(std::span<const double> point) {
    if (search_.stop.stop_requested()) throw Interrupted("stopped on request");
    const auto hyperparameters = search_.space->decode(point);
    const auto key = key_of(hyperparameters);
    if (const auto known = values_.find(key); known != values_.end()) return known->second;
    if (values_.size() >= static_cast<std::size_t>(search_.trials)) throw SearchEnded{};
    const auto trial = run_trial(hyperparameters, key, 0);
    values_.emplace(key, trial.value);
    halving_.record(trial.rungs);
    result_.trials.push_back(trial);
    if (better_than_incumbent(trial)) incumbent_ = trial.value;
    progress();
    if (values_.size() >= static_cast<std::size_t>(search_.trials)) throw SearchEnded{};
    return trial.value;
  }

  bool better_than_incumbent(const Row& trial) const { return !trial.pruned && trial.value < incumbent_; }

  Row run_trial(const NamedValues& hyperparameters, const std::string& key, int i_seed) {
    if (search_.store != nullptr) {
      if (auto stored = search_.store->find(search_.digest, key, i_seed)) {
        ++result_.n_replayed;
        return *stored;
      }
    }
    const base::Stopwatch watch;
    RungMonitor monitor(halving_, values_.size(), search_.prune && i_seed == 0);
    const auto seed = search_.seed.derive("trial").derive(key).derive(static_cast<std::uint64_t>(i_seed));
    const auto trained = search_.evaluate(hyperparameters, seed, &monitor);
    Row trial{.hyperparameters = hyperparameters,
              .i_seed = i_seed,
              .value = finite(trained.validation_mse),
              .epochs = trained.epochs,
              .pruned = trained.pruned,
              .diverged = trained.diverged,
              .seconds = watch.seconds(),
              .rungs = monitor.reached()};
    if (trained.diverged)
      trial.value = diverged_value(hyperparameters);
    else if (trained.pruned)
      trial.value = monitor.best();
    if (search_.store != nullptr) search_.store->add(search_.digest, search_.name, key, trial);
    return trial;
  }

  void progress() {
    search_.log->progress({"search " + search_.name, static_cast<std::int64_t>(values_.size()),
                           search_.trials, "trials",
                           incumbent_ < HUGE_VAL ? base::rounded(incumbent_) : std::string()});
  }

  void tell_lost() const {
    const auto n_lost = std::ranges::count_if(result_.trials, &Row::diverged);
    if (n_lost == 0) return;
    search_.log->info(fmt::format("search {}: {} of {} trainings diverged and are lost", search_.name, n_lost,
                                  result_.trials.size()));
  }

  // Trials that ended by themselves, best first; a diverged one only when there is no other.
  std::vector<Row> candidates() const {
    std::vector<Row> sorted;
    for (const auto& trial : result_.trials)
      if (!trial.pruned) sorted.push_back(trial);
    if (sorted.empty()) sorted = result_.trials;
    std::ranges::stable_sort(sorted, {}, &Row::value);
    return sorted;
  }

  void confirm() {
    auto sorted = candidates();
    check(!sorted.empty(), "search: at least one trial");
    if (search_.confirm < 2 || sorted.size() < 2) return choose(sorted);
    sorted.resize(std::min(sorted.size(), static_cast<std::size_t>(search_.confirm)));
    for (auto& trial : sorted) {
      double sum = 0;
      for (int i_seed = 1; i_seed <= search_.confirm_seeds; ++i_seed) {
        if (search_.stop.stop_requested()) throw Interrupted("stopped on request");
        const auto again = run_trial(trial.hyperparameters, key_of(trial.hyperparameters), i_seed);
        result_.trials.push_back(again);
        sum += again.value;
      }
      trial.value = sum / search_.confirm_seeds;
    }
    choose(sorted);
  }

  void choose(const std::vector<Row>& among) {
    const Row& best = *std::ranges::min_element(among, {}, &Row::value);
    result_.best = best.hyperparameters;
    result_.validation_mse = best.value;
    std::map<std::string, NamedValues> near;
    for (const Row& trial : among)
      if (trial.value <= nearly * best.value)
        near.emplace(key_of(trial.hyperparameters), trial.hyperparameters);
    for (auto& [key, hyperparameters] : near) result_.near_best.push_back(std::move(hyperparameters));
  }

  const ValueSearch& search_;
  Halving halving_;
  std::map<std::string, double> values_;  // by key: the memo
  double incumbent_ = HUGE_VAL;
  SearchResultOf<NamedValues> result_;
};

}  // namespace

SearchResultOf<NamedValues> ValueSearch::run() const { return Searcher(*this).run(); }

}  // namespace elrom::networks
