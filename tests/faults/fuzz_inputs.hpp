#pragma once
// Fuzzing without a fuzzer: seeds changed at random, reproducibly, under any compiler.

#include "campaign.hpp"

namespace elrom::faults {

/// Every target with changed seeds, in child processes: no crash, no exception that is not ours, no input
/// that takes more than a second, and memory within limits. One count an input.
Tally fuzz_inputs(const Workshop& workshop);

}  // namespace elrom::faults
