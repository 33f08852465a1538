#pragma once
// What a fuzzer may throw anything at. A target returns for every input: our errors are caught, everything
// else (a crash, an exception that is not ours, a hang, memory out of proportion) is a finding.

#include <cstddef>
#include <cstdint>
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
/// the input), cases_csv, cases_json, cases_toml, fluent_ascii, foam.
[[nodiscard]] const std::vector<FuzzTarget>& fuzz_targets();

/// Small valid inputs to start from; the first byte files of a corpus.
[[nodiscard]] std::vector<std::string> seeds_of(const std::string& target);

}  // namespace elrom::faults
