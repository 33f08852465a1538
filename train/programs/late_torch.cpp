#include "late_torch.hpp"

#include <dlfcn.h>

#include <mutex>

#include "elrom/base/error.hpp"

namespace elrom::programs {
namespace {

constexpr const char* shared_object = "elrom-torch.so";  // found by the program's run path

/// It stays loaded: LibTorch does not survive being unloaded.
std::unique_ptr<networks::Trainer> load_torch_trainer(const std::string& device) {
  using Make = networks::Trainer*(const char*);
  void* const loaded = ::dlopen(shared_object, RTLD_LAZY | RTLD_LOCAL);
  void* const make = loaded == nullptr ? nullptr : ::dlsym(loaded, "elrom_make_torch_trainer");
  if (make == nullptr) {
    throw NotBuiltError({.what = "LibTorch, which trains the networks, cannot be loaded",
                         .where = shared_object,
                         .found = ::dlerror(),
                         .advice = "install LibTorch, or train without networks: --set method=kernel"});
  }
  return std::unique_ptr<networks::Trainer>(reinterpret_cast<Make*>(make)(device.c_str()));
}

class LateTorchTrainer final : public networks::Trainer {
 public:
  explicit LateTorchTrainer(std::string device) : device_(std::move(device)) {
    if (device_ != "cpu") (void)loaded();
  }

  [[nodiscard]] std::string name() const override { return "torch:" + device_; }

  [[nodiscard]] networks::TrainingResult train(const networks::TrainingProblem& problem,
                                               const networks::Hyperparameters& hyperparameters,
                                               const networks::TrainingBudget& budget, base::Seed seed,
                                               networks::TrainingMonitor* monitor,
                                               const std::stop_token& stop,
                                               const std::filesystem::path& checkpoint) const override {
    return loaded().train(problem, hyperparameters, budget, seed, monitor, stop, checkpoint);
  }

 private:
  const networks::Trainer& loaded() const {
    std::call_once(once_, [&] { trainer_ = load_torch_trainer(device_); });
    return *trainer_;
  }

  std::string device_;
  mutable std::once_flag once_;
  mutable std::unique_ptr<networks::Trainer> trainer_;
};

}  // namespace

std::shared_ptr<const networks::Trainer> late_torch_trainer(const std::string& device) {
  return std::make_shared<LateTorchTrainer>(device);
}

}  // namespace elrom::programs
