#include "elrom/networks/trainer.hpp"

namespace elrom::networks {

void tell_divergence(const TrainingResult& result, const std::string& network, Log& log) {
  if (result.diverged)
    log.warning(network + " diverged and is lost");
  else if (result.backed_off)
    log.warning(network + " diverged and was begun again at a tenth of its learning rate");
}

}  // namespace elrom::networks
