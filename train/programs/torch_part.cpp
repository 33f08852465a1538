// The shared object that late_torch.cpp loads.
#include "elrom/torch/trainer.hpp"

extern "C" elrom::networks::Trainer* elrom_make_torch_trainer(const char* device) {
  return elrom::torch::make_torch_trainer(device).release();
}
