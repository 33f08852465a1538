#include "elrom/networks/trainer.hpp"

namespace elrom::networks {

MatrixF parameters_of(const model::Network& network) {
  std::vector<float> values;
  for (const auto& layer : network.layers()) {
    for (const auto* part : {&layer.weights, &layer.bias}) {
      const auto own = part->f32();
      values.insert(values.end(), own.begin(), own.end());
    }
  }
  return Eigen::Map<const MatrixF>(values.data(), values.empty() ? 0 : 1,
                                   static_cast<Eigen::Index>(values.size()));
}

void tell_divergence(const TrainingResult& result, const std::string& network, Log& log) {
  if (result.diverged)
    log.warning(network + " diverged and is lost");
  else if (result.backed_off)
    log.warning(network + " diverged and was begun again at a tenth of its learning rate");
}

}  // namespace elrom::networks
