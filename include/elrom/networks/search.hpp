#pragma once
// Search for a submodel's hyperparameters with NLopt's derivative-free algorithms over the unit cube.
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
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/base/random.hpp"
#include "elrom/networks/settings.hpp"
#include "elrom/networks/trainer.hpp"
#include "elrom/networks/trial_store.hpp"

namespace elrom::networks {

class SearchSpace {
 public:
  explicit SearchSpace(const SearchSettings& settings,
                       model::Activation activation = model::Activation::relu);

  [[nodiscard]] std::size_t n_dimensions() const { return axes_.size(); }
  /// @param point in the unit cube, (n_dimensions()); values outside are clamped
  [[nodiscard]] Hyperparameters decode(std::span<const double> point) const;
  /// Text that is equal for equal hyperparameters.
  [[nodiscard]] static std::string key(const Hyperparameters& hyperparameters);
  /// Initial step of local algorithms: at least one bin of every axis.
  [[nodiscard]] std::vector<double> initial_step() const;

 private:
  struct Axis {
    std::string name;
    std::vector<double> values;  ///< one a bin
  };
  std::vector<Axis> axes_;
  model::Activation activation_;
};

/// Trains once with these hyperparameters.
using Evaluate = std::function<TrainingResult(const Hyperparameters&, base::Seed, TrainingMonitor*)>;

struct SearchContext {
  std::string name;    ///< for people: "pressure, 0.1 to 0.2"
  std::string digest;  ///< identity in the trial store: digest of data and settings
  base::Seed seed{1};
  TrialStore* store = nullptr;  ///< may be missing: nothing is kept
  Log* log = &silent_log();
  std::stop_token stop;
};

struct SearchResult {
  Hyperparameters best;
  double validation_mse = 0;   ///< mean over the seeds that confirmed it, or of its one trial
  std::vector<Trial> trials;   ///< all, in order; confirmations (i_seed > 0) at the end
  std::size_t n_replayed = 0;  ///< trials taken from the store
};

/// The same seed and settings give the same winner, with or without stored trials. Runs on the calling thread
/// alone. Every value is finite: a diverged trial counts as worst_value.
/// @throws Interrupted; whatever evaluate throws
[[nodiscard]] SearchResult search(const Evaluate& evaluate, const SearchSettings& settings,
                                  const SearchSpace& space, const SearchContext& context);
inline constexpr double worst_value = 1e6;

}  // namespace elrom::networks
