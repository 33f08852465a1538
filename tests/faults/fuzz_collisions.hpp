#pragma once
// Sets of collisions and collision models as a fuzzer throws them.

#include <string>
#include <vector>

#include "fuzz_targets.hpp"

namespace elrom::faults {

/// Small good files, made anew in the format of the day; of a target that follows its input, some numbers.
[[nodiscard]] std::vector<std::string> collision_seeds(const std::string& target);

void fuzz_collisions(Bytes input);
void fuzz_collisions_content(Bytes input);
void fuzz_collision_model(Bytes input);
void fuzz_collision_model_content(Bytes input);

}  // namespace elrom::faults
