#pragma once
// A training on disk (data/FORMATS.md, kind "elrom-checkpoint"): resumed, it ends with the same bits.

#include <filesystem>
#include <string>

#include "training.hpp"

namespace elrom::torch {

/// Identity of a training: its data, hyperparameters, budget and seed.
[[nodiscard]] std::string training_digest(const networks::TrainingProblem& problem,
                                          const networks::Hyperparameters& hyperparameters,
                                          const networks::TrainingBudget& budget, base::Seed seed);

void save_checkpoint(const std::filesystem::path& path, const std::string& digest, Training& training);

/// Takes the state of a checkpoint over.
/// @return false when there is none, when it is of another training, or when it cannot be read: then the
///         training starts from nothing, which costs time and nothing else
[[nodiscard]] bool load_checkpoint(const std::filesystem::path& path, const std::string& digest,
                                   Training& training);

}  // namespace elrom::torch
