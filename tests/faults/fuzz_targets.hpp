#pragma once
// What a fuzzer may throw anything at. A target returns for every input: our errors are caught, everything
// else (a crash, an exception that is not ours, a hang, memory out of proportion) is a finding.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace elrom::faults {

using Bytes = std::span<const std::uint8_t>;

struct FuzzTarget {
  std::string name;
  void (*run)(Bytes input);
};

/// bundle (a file of any bytes), bundle_content (a bundle with true digests whose texts and tensors follow
/// the input), cases_csv, cases_json, cases_toml, fluent_ascii, foam, vtu; collisions (a file of any
/// bytes), collisions_content (a set whose values, shapes and settings follow the input), collision_model and
/// collision_model_content as those of bundles; those of fuzz_service.hpp.
[[nodiscard]] const std::vector<FuzzTarget>& fuzz_targets();

/// Small inputs to start from, and inputs that once did harm: the files of tests/faults/corpus/<target>;
/// bundles are made anew, of every kind, in the format of the day.
[[nodiscard]] std::vector<std::string> seeds_of(const std::string& target);

}  // namespace elrom::faults
