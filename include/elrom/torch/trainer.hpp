#pragma once
// The trainer of one network on LibTorch: Adam with decoupled weight decay
// (Kingma & Ba 2015; Loshchilov & Hutter 2019), mean squared error over the
// targets that count, early stopping with the best weights restored.
//
// One LibTorch thread a build: builds run side by side on base::parallel_for, which beats threads inside
// small products. Randomness comes from the seed's own streams ("weights", "order", "dropout"), never from
// LibTorch's generators. A loss that is not finite sends the training back to its first weights at a tenth of
// the rate, once; then it is lost.

#include <memory>
#include <string>

#include "elrom/networks/trainer.hpp"

namespace elrom::torch {

/// @param device "cpu", "cuda", "cuda:1" ... @throws UsageError for another name, NotBuiltError for a device
///               that this LibTorch does not have
[[nodiscard]] std::unique_ptr<networks::Trainer> make_torch_trainer(const std::string& device = "cpu");

}  // namespace elrom::torch
