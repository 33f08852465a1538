#pragma once
// Fuzzing without a fuzzer: seeds changed at random, reproducibly, under any compiler; and with one.

#include "campaign.hpp"

namespace elrom::faults {

/// Every target with changed seeds, in child processes: no crash, no exception that is not ours, no input
/// that takes more than a second, and memory within limits. One count an input.
Tally fuzz_inputs(const Workshop& workshop);

/// The same targets by libFuzzer, under the sanitizers, with Workshop::n_fuzz inputs in all; skipped where
/// its programs are not built. An input that did harm is left in the working folder.
Tally fuzz_programs(const Workshop& workshop);

}  // namespace elrom::faults
