#pragma once
// Search for hyperparameters, of networks or any other struct of them, with NLopt's derivative-free
// algorithms over the unit cube.
//
// A point is decoded to hyperparameters (logarithmic bins for rates, units and batch sizes,
// equal bins for layers); decoded points are memoised and only distinct ones count as trials.
// Hopeless trials are pruned by asynchronous successive halving (Li et al. 2020: eta 3, rungs
// at 1/9 and 1/3 of the longest training, never the first 8 trials). The best trials are
// built again with other seeds, because noise flatters the incumbent.

#include <functional>
#include <span>
#include <stop_token>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/base/random.hpp"
#include "elrom/networks/settings.hpp"
#include "elrom/networks/trainer.hpp"
#include "elrom/networks/trial_store.hpp"

namespace elrom::networks {

/// The unit cube over some hyperparameters; the others stay what they are.
class ValueSpace {
 public:
  struct Axis {
    std::string name;
    std::vector<double> values;  ///< one a bin
  };
  /// @param axes in any order; each names a number of `fixed`
  ValueSpace(NamedValues fixed, std::vector<Axis> axes);

  [[nodiscard]] std::size_t n_dimensions() const { return axes_.size(); }
  [[nodiscard]] NamedValues decode(std::span<const double> point) const;
  [[nodiscard]] std::vector<double> initial_step() const;

 private:
  NamedValues fixed_;
  std::vector<Axis> axes_;           // in the hyperparameters' order
  std::vector<std::size_t> places_;  // of each axis among the hyperparameters
};

/// From low to high, a fixed number of bins a decade, each value rounded to three digits.
[[nodiscard]] std::vector<double> log_bins(const std::vector<double>& range, double bins_a_decade);
/// low, then steps by `factor` rounded to whole numbers (multiples of 8 above 16), high.
[[nodiscard]] std::vector<double> size_bins(const std::vector<double>& range, double factor);
[[nodiscard]] std::vector<double> whole_bins(const std::vector<double>& range);
[[nodiscard]] std::vector<double> even_bins(const std::vector<double>& range, std::size_t n);

template <class H>
class SearchSpaceOf {
 public:
  SearchSpaceOf(const H& fixed, std::vector<ValueSpace::Axis> axes)
      : values_(to_values(fixed), std::move(axes)) {}

  [[nodiscard]] std::size_t n_dimensions() const { return values_.n_dimensions(); }
  /// @param point in the unit cube, (n_dimensions()); values outside are clamped
  [[nodiscard]] H decode(std::span<const double> point) const {
    return from_values<H>(values_.decode(point));
  }
  /// Text that is equal for equal hyperparameters.
  [[nodiscard]] static std::string key(const H& hyperparameters) {
    return key_of(to_values(hyperparameters));
  }
  /// Initial step of local algorithms: at least one bin of every axis.
  [[nodiscard]] std::vector<double> initial_step() const { return values_.initial_step(); }
  [[nodiscard]] const ValueSpace& values() const { return values_; }

 private:
  ValueSpace values_;
};

/// Of networks.
class SearchSpace : public SearchSpaceOf<Hyperparameters> {
 public:
  explicit SearchSpace(const SearchSettings& settings,
                       model::Activation activation = model::Activation::relu);
};

/// Trains once with these hyperparameters.
template <class H>
using EvaluateOf = std::function<TrialOutcome(const H&, base::Seed, TrainingMonitor*)>;
using Evaluate = EvaluateOf<Hyperparameters>;

template <class H>
struct SearchContextOf {
  std::string name;    ///< for people: "pressure, 0.1 to 0.2"
  std::string digest;  ///< identity in the trial store: digest of data and settings
  base::Seed seed{1};
  TrialStoreOf<H>* store = nullptr;  ///< may be missing: nothing is kept
  Log* log = &silent_log();
  std::stop_token stop;
};
using SearchContext = SearchContextOf<Hyperparameters>;

template <class H>
struct SearchResultOf {
  H best;
  /// The best and whatever comes within a tenth of its error, of those confirmed where some are, in the order
  /// of their keys. Which of these is the best is chance; the set of them stands where data change in a last
  /// bit.
  std::vector<H> near_best;
  double validation_mse = 0;       ///< mean over the seeds that confirmed it, or of its one trial
  std::vector<TrialOf<H>> trials;  ///< all, in order; confirmations (i_seed > 0) at the end
  std::size_t n_replayed = 0;      ///< trials taken from the store
};
using SearchResult = SearchResultOf<Hyperparameters>;

/// A search without types: what search() is made of.
struct ValueSearch {
  EvaluateOf<NamedValues> evaluate;
  const ValueSpace* space;
  std::string algorithm;
  int trials;
  bool prune;
  int confirm, confirm_seeds, max_epochs;
  std::string name, digest;
  base::Seed seed;
  TrialTable* store;
  Log* log;
  std::stop_token stop;

  [[nodiscard]] SearchResultOf<NamedValues> run() const;
};

/// The same seed and settings give the same winner, with or without stored trials. Runs on the calling thread
/// alone. Every value is finite: a diverged trial counts as worst_value.
/// @param settings with the members of SearchSettings from algorithm to max_epochs; epochs are whatever the
/// monitor is told of (rounds, for boosted trees)
/// @throws Interrupted; whatever evaluate throws
template <class H, class Settings>
[[nodiscard]] SearchResultOf<H> search(const std::type_identity_t<EvaluateOf<H>>& evaluate,
                                       const Settings& settings, const SearchSpaceOf<H>& space,
                                       const std::type_identity_t<SearchContextOf<H>>& context) {
  const ValueSearch untyped{
      .evaluate = [&](const NamedValues& values, base::Seed seed,
                      TrainingMonitor* monitor) { return evaluate(from_values<H>(values), seed, monitor); },
      .space = &space.values(),
      .algorithm = settings.algorithm,
      .trials = settings.trials,
      .prune = settings.prune,
      .confirm = settings.confirm,
      .confirm_seeds = settings.confirm_seeds,
      .max_epochs = settings.max_epochs,
      .name = context.name,
      .digest = context.digest,
      .seed = context.seed,
      .store = context.store == nullptr ? nullptr : &context.store->table(),
      .log = context.log,
      .stop = context.stop};
  const auto found = untyped.run();
  SearchResultOf<H> result{from_values<H>(found.best), {}, found.validation_mse, {}, found.n_replayed};
  for (const auto& values : found.near_best) result.near_best.push_back(from_values<H>(values));
  for (const auto& trial : found.trials) result.trials.push_back(typed<H>(trial));
  return result;
}
inline constexpr double worst_value = 1e6;

}  // namespace elrom::networks
