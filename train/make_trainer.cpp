// The one place that knows whether LibTorch is part of this build.
#include "commands.hpp"
#include "elrom/base/error.hpp"
#if ELROM_HAS_TORCH
#include "elrom/torch/trainer.hpp"
#endif

namespace elrom::train {

#if ELROM_HAS_TORCH
study::Toolbox make_toolbox(const study::Settings& settings) {
  return {.trainer = elrom::torch::make_torch_trainer(settings.device)};
}
#else
study::Toolbox make_toolbox(const study::Settings& settings) {
  if (settings.device != "cpu") {
    throw NotBuiltError({.what = "device " + settings.device + " needs LibTorch, which this build left out",
                         .advice = "build with -DELROM_TORCH=ON"});
  }
  return {};
}
#endif

}  // namespace elrom::train
