#pragma once
// One training of one network: its state, an epoch, an evaluation. The trainer decides when to stop.

#include <cstdint>
#include <string>
#include <vector>

#include "adam.hpp"
#include "elrom/networks/trainer.hpp"
#include "mlp.hpp"
#include "records.hpp"

namespace elrom::torch {

/// What a training has come to, beside its tensors; written to checkpoints.
struct Progress {
  int epoch = 0;  ///< epochs done
  double learning_rate = 0;
  bool backed_off = false;  ///< the rate was lowered after a loss that was not finite
  int best_epoch = 0;
  double best_validation = 0, best_train = 0;  ///< MSE of the best epoch
  std::vector<double> history;                 ///< validation MSE of each epoch
};

class Training {
 public:
  Training(const networks::TrainingProblem& problem, const networks::Hyperparameters& hyperparameters,
           base::Seed seed, Place place);

  /// Some training records (TrainingBudget::epoch_records) in a random order, every sweep over all of them in
  /// its own, then an evaluation; keeps the best weights. @param rate_factor of the learning rate
  /// @return false when a loss was not finite
  bool run_epoch(int most_records = 0, double rate_factor = 1);
  /// Back to the first weights, the problem's or the seed's, at another rate.
  void restart(double learning_rate);
  /// One step on the records `rows`; also what bench-step times.
  void step(std::span<const std::int64_t> rows);
  [[nodiscard]] double evaluate();

  [[nodiscard]] Progress& progress() { return progress_; }
  [[nodiscard]] Mlp& mlp() { return mlp_; }
  [[nodiscard]] Adam& adam() { return adam_; }
  [[nodiscard]] ::torch::Tensor& best() { return best_; }

 private:
  [[nodiscard]] Pass& pass_of(std::int64_t n_rows);
  /// The records of the epoch that comes next.
  [[nodiscard]] std::span<const std::int64_t> next_records(int most_records);
  void residual(Pass& pass, double scale);
  [[nodiscard]] double take_sum();

  networks::Hyperparameters hyperparameters_;
  base::Seed seed_;
  MatrixF start_;
  bool own_loops_;
  Records train_, validation_;
  Mlp mlp_;
  Adam adam_;
  ::torch::Tensor best_, sum_of_squares_;
  std::vector<Pass> train_passes_, evaluation_passes_;
  std::vector<std::int64_t> order_, all_rows_;
  double rate_factor_ = 1;
  base::Random dropout_random_;
  Progress progress_;
};

/// The processor's denormals are flushed to zero and LibTorch's threads are one while it lives: means of dead
/// units decay into denormals, which are slow.
class OneFastThread {
 public:
  OneFastThread();
  ~OneFastThread();
  OneFastThread(const OneFastThread&) = delete;
  OneFastThread& operator=(const OneFastThread&) = delete;

 private:
  c10::InferenceMode no_graph_;
};

}  // namespace elrom::torch
