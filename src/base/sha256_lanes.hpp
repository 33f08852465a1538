#pragma once
// SHA-256 of several texts on one core. A processor's SHA instructions wait for each other within a text; two
// texts in step fill the gaps, and take little longer than one. Internal to base.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace elrom::base {

/// Whether this processor has the instructions.
[[nodiscard]] bool has_sha_instructions();

using Sha256Words = std::array<std::uint32_t, 8>;  ///< as FIPS 180-4 orders them
/// Only where has_sha_instructions().
[[nodiscard]] std::vector<Sha256Words> sha256_in_lanes(std::span<const std::span<const std::byte>> texts);

}  // namespace elrom::base
