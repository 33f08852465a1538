#include "elrom/torch/trainer.hpp"

#include <torch/cuda.h>

#include <chrono>
#include <limits>

#include "checkpoint.hpp"
#include "elrom/base/error.hpp"
#include "training.hpp"

namespace elrom::torch {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds checkpoint_interval{10};
constexpr double back_off = 0.1;

::torch::Device device_of(const std::string& name) {
  if (name == "cpu") return ::torch::kCPU;
  if (name != "cuda" && name.rfind("cuda:", 0) != 0)
    throw UsageError({"unknown device", {}, name, "cpu, cuda or cuda:0, cuda:1 ..."});
  if (!::torch::cuda::is_available())
    throw NotBuiltError(Problem{"no CUDA device in this LibTorch", {}, name, {}, "use --device cpu"});
  try {
    const ::torch::Device device(name);
    if (device.has_index() &&
        static_cast<std::size_t>(device.index()) >= static_cast<std::size_t>(::torch::cuda::device_count()))
      throw UsageError(
          {"no such device", {}, name, std::to_string(::torch::cuda::device_count()) + " devices"});
    return device;
  } catch (const c10::Error&) {
    throw UsageError({"unknown device", {}, name, "cpu, cuda or cuda:0, cuda:1 ..."});
  }
}

/// One call of train().
class TrainCall {
 public:
  TrainCall(const networks::TrainingProblem& problem, const networks::Hyperparameters& hyperparameters,
            const networks::TrainingBudget& budget, base::Seed seed, ::torch::Device device,
            std::filesystem::path checkpoint)
      : training_(problem, hyperparameters, seed, {device}),
        budget_(budget),
        checkpoint_(std::move(checkpoint)) {
    if (!checkpoint_.empty()) digest_ = training_digest(problem, hyperparameters, budget, seed);
  }

  networks::TrainingResult run(networks::TrainingMonitor* monitor, const std::stop_token& stop) {
    bool pruned = load_checkpoint(checkpoint_, digest_, training_) && !replay(monitor);
    while (!pruned && !finished()) {
      if (stop.stop_requested()) interrupt();
      if (!training_.run_epoch(budget_.epoch_records, rate_factor(budget_, progress().epoch))) {
        if (training_.progress().backed_off) return finish(false, true);
        training_.progress().backed_off = true;
        training_.restart(training_.progress().learning_rate * back_off);
        continue;
      }
      pruned = monitor != nullptr && !monitor->keep_going(progress().epoch, progress().history.back());
      save_when_due();
    }
    return finish(pruned, false);
  }

 private:
  [[nodiscard]] Progress& progress() { return training_.progress(); }

  [[nodiscard]] bool finished() {
    return progress().epoch >= budget_.max_epochs ||
           progress().epoch - progress().best_epoch >= budget_.patience;
  }

  /// Tells the monitor of the epochs before the checkpoint. @return false when it gives the training up
  [[nodiscard]] bool replay(networks::TrainingMonitor* monitor) {
    if (monitor == nullptr) return true;
    for (std::size_t i = 0; i < progress().history.size(); ++i)
      if (!monitor->keep_going(static_cast<int>(i) + 1, progress().history[i])) return false;
    return true;
  }

  [[noreturn]] void interrupt() {
    if (!checkpoint_.empty()) save_checkpoint(checkpoint_, digest_, training_);
    throw Interrupted("training stopped on request after epoch " + std::to_string(progress().epoch));
  }

  void save_when_due() {
    if (checkpoint_.empty() || Clock::now() - saved_ < checkpoint_interval) return;
    save_checkpoint(checkpoint_, digest_, training_);
    saved_ = Clock::now();
  }

  networks::TrainingResult finish(bool pruned, bool diverged) {
    std::error_code ignored;
    if (!checkpoint_.empty()) std::filesystem::remove(checkpoint_, ignored);
    networks::TrainingResult result;
    result.epochs = progress().epoch;
    result.pruned = pruned;
    result.diverged = diverged || progress().best_epoch == 0;
    result.backed_off = progress().backed_off;
    const double worst = std::numeric_limits<double>::max();
    result.validation_mse = result.diverged ? worst : progress().best_validation;
    result.train_mse = result.diverged ? worst : progress().best_train;
    if (!result.diverged) result.network = training_.mlp().network(training_.best());
    return result;
  }

  Training training_;
  networks::TrainingBudget budget_;
  std::filesystem::path checkpoint_;
  std::string digest_;
  Clock::time_point saved_ = Clock::now();
};

class TorchTrainer final : public networks::Trainer {
 public:
  explicit TorchTrainer(::torch::Device device) : device_(device) {}

  [[nodiscard]] std::string name() const override { return "torch:" + device_.str(); }

  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem& problem,
                                               const networks::Hyperparameters& hyperparameters,
                                               const networks::TrainingBudget& budget, base::Seed seed,
                                               networks::TrainingMonitor* monitor,
                                               const std::stop_token& stop,
                                               const std::filesystem::path& checkpoint) const override {
    const OneFastThread guard;
    return TrainCall(problem, hyperparameters, budget, seed, device_, checkpoint).run(monitor, stop);
  }

 private:
  ::torch::Device device_;
};

}  // namespace

std::unique_ptr<networks::Trainer> make_torch_trainer(const std::string& device) {
  return std::make_unique<TorchTrainer>(device_of(device));
}

}  // namespace elrom::torch
