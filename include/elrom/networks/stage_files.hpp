#pragma once
// Stage results as tensor files and back. Internal to the study.

#include <span>
#include <vector>

#include "elrom/io/tensor_file.hpp"
#include "elrom/networks/screening.hpp"
#include "elrom/networks/trainer.hpp"

namespace elrom::networks {

[[nodiscard]] io::TensorFile to_file(const ScreeningResult& screening);
[[nodiscard]] ScreeningResult screening_of(const io::TensorFile& file);

[[nodiscard]] io::TensorFile to_file(const TrainingResult& result);
[[nodiscard]] TrainingResult training_of(const io::TensorFile& file);

/// @param hyperparameters at least one @param validation_mse of the best
[[nodiscard]] io::TensorFile to_file(std::span<const Hyperparameters> hyperparameters, double validation_mse);
[[nodiscard]] std::vector<Hyperparameters> hyperparameters_of(const io::TensorFile& file);

}  // namespace elrom::networks
