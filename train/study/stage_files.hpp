#pragma once
// Stage results as tensor files and back. Internal to the study.

#include "elrom/io/tensor_file.hpp"
#include "elrom/study/networks_method.hpp"
#include "elrom/study/screening.hpp"
#include "elrom/study/trainer.hpp"

namespace elrom::study {

[[nodiscard]] io::TensorFile to_file(const ScreeningResult& screening);
[[nodiscard]] ScreeningResult screening_of(const io::TensorFile& file);

[[nodiscard]] io::TensorFile to_file(const TrainingResult& result);
[[nodiscard]] TrainingResult training_of(const io::TensorFile& file);

[[nodiscard]] io::TensorFile to_file(const Hyperparameters& hyperparameters, double validation_mse);
[[nodiscard]] Hyperparameters hyperparameters_of(const io::TensorFile& file);

}  // namespace elrom::study
