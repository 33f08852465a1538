#pragma once
// Secrets: made from the system's randomness, kept as their digest, compared in a time that tells nothing.
//
// Thread rule: pure functions.

#include <string>
#include <string_view>

namespace elrom::repository {

/// 64 hexadecimal digits of 256 random bits. @throws SystemError
[[nodiscard]] std::string random_secret();
/// SHA-256; enough for what is random itself, and as quick as many requests a second need it.
[[nodiscard]] std::string secret_hash(std::string_view secret);
/// Looks at every character, whatever the first ones are.
[[nodiscard]] bool same_in_constant_time(std::string_view a, std::string_view b);

}  // namespace elrom::repository
