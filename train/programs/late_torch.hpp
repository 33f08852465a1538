#pragma once
// LibTorch, loaded when a network is first trained: by itself it costs each start of a program 0.4 s.

#include <memory>
#include <string>

#include "elrom/networks/trainer.hpp"

namespace elrom::programs {

/// The trainer of elrom::torch (elrom/torch/trainer.hpp), from the shared object beside the program's
/// libraries. "cpu" loads it with the first call of train(); any other device at once, for LibTorch must
/// say whether it is there. @throws UsageError, NotBuiltError as make_torch_trainer does; NotBuiltError
/// too, here or from train(), when the shared object does not load
[[nodiscard]] std::shared_ptr<const networks::Trainer> late_torch_trainer(const std::string& device);

}  // namespace elrom::programs
