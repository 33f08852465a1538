#pragma once
// The seam between the study and the machine that trains one network: the search is tested with a fake
// trainer, and LibTorch's headers stay in train/torch.

#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>

#include "elrom/base/log.hpp"
#include "elrom/base/random.hpp"
#include "elrom/math/matrix.hpp"
#include "elrom/model/network.hpp"
#include "elrom/networks/hyperparameters.hpp"

namespace elrom::networks {

struct TrainingBudget {
  int max_epochs = 200;
  int patience = 20;  ///< epochs without a better validation error before stopping
  /// Training records of one epoch at most, 0: all of them. The next epoch goes on where it ended, so that
  /// none is left out: records that are many need no more steps than few do.
  int epoch_records = 0;
  /// The learning rate falls to nothing by half a cosine over max_epochs (Loshchilov & Hutter 2017)
  bool anneal = false;
};
/// Of the learning rate in an epoch (from 0).
[[nodiscard]] double rate_factor(const TrainingBudget& budget, int epoch);

/// The records that one epoch visits: a piece of a sweep over all of them in the sweep's own random order.
struct EpochPart {
  std::size_t sweep = 0, first = 0, size = 0;
};
/// Epoch by epoch (from 0) through sweeps that are cut into as few pieces as hold at most so many records.
/// @param most_records TrainingBudget::epoch_records
[[nodiscard]] EpochPart epoch_part(std::size_t n_records, int most_records, std::size_t epoch);

/// Standardised records. With a mask only the masked-in targets count: mask(record's plane, output).
struct TrainingProblem {
  MatrixF train_inputs, train_targets;            //!< (n_train, n_in), (n_train, n_out)
  MatrixF validation_inputs, validation_targets;  //!< (n_validation, ...)
  MatrixF train_weights, validation_weights;      //!< 0 or 1 for every target, same shape; empty: all count
  MatrixF start;                                  //!< parameters_of() to begin at; empty: drawn from the seed
};

/// Weights (n_out, n_in), then bias, layer after layer, (1, n_parameters); empty for an empty network.
[[nodiscard]] MatrixF parameters_of(const model::Network& network);

/// Told the validation error after each epoch.
class TrainingMonitor {
 public:
  virtual ~TrainingMonitor() = default;
  /// @param epoch ended epochs, from 1
  /// @return false to give this training up (pruned)
  virtual bool keep_going(int epoch, double validation_mse) = 0;
};

/// What the search learns of a training.
struct TrialOutcome {
  double validation_mse = 0;
  int epochs = 0;
  bool pruned = false;
  bool diverged = false;
};

struct TrainingResult {
  model::Network network;     ///< the weights of the best epoch; empty when diverged
  double validation_mse = 0;  ///< of the best epoch, standardised units
  double train_mse = 0;
  int epochs = 0;
  bool pruned = false;
  bool diverged = false;  ///< a loss that was not finite: the trial loses, never a NaN winner (scores are the
                          ///< largest finite number)
  /// After a first such loss it was begun again at a tenth of the rate: tell the user
  bool backed_off = false;

  operator TrialOutcome() const { return {validation_mse, epochs, pruned, diverged}; }
};

/// Warns when a training diverged: it is lost, or was begun again at a tenth of its rate.
void tell_divergence(const TrainingResult& result, const std::string& network, Log& log);

/// Thread rule: train() may run on several threads at a time; each call uses one thread.
class Trainer {
 public:
  virtual ~Trainer() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  [[nodiscard]] std::string key() const { return name(); }  ///< in the keys of stages that train
  /// The same arguments give the same bits. Weights that the training begins at do not count as an epoch:
  /// what comes out has seen these records. @param checkpoint file to resume from and to save to; empty: none
  /// @throws Interrupted on `stop`
  [[nodiscard]] virtual TrainingResult train(const TrainingProblem& problem,
                                             const Hyperparameters& hyperparameters,
                                             const TrainingBudget& budget, base::Seed seed,
                                             TrainingMonitor* monitor, const std::stop_token& stop,
                                             const std::filesystem::path& checkpoint = {}) const = 0;
};

}  // namespace elrom::networks
