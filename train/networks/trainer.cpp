#include "elrom/networks/trainer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

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

double rate_factor(const TrainingBudget& budget, int epoch) {
  if (!budget.anneal) return 1;
  return 0.5 * (1 + std::cos(std::numbers::pi * epoch / budget.max_epochs));
}

EpochPart epoch_part(std::size_t n_records, int most_records, std::size_t epoch) {
  const std::size_t most = most_records > 0 ? static_cast<std::size_t>(most_records) : n_records;
  const std::size_t n_parts =
      std::max<std::size_t>(1, (n_records + most - 1) / std::max<std::size_t>(1, most));
  const std::size_t part = epoch % n_parts, first = part * n_records / n_parts;
  return {epoch / n_parts, first, (part + 1) * n_records / n_parts - first};
}

void tell_divergence(const TrainingResult& result, const std::string& network, Log& log) {
  if (result.diverged)
    log.warning(network + " diverged and is lost");
  else if (result.backed_off)
    log.warning(network + " diverged and was begun again at a tenth of its learning rate");
}

}  // namespace elrom::networks
