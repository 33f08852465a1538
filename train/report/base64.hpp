#pragma once
// Base64 (RFC 4648, section 4), for binary data inside the page.

#include <cstdint>
#include <span>
#include <string>

namespace elrom::report {

[[nodiscard]] std::string base64(std::span<const std::uint8_t> bytes);

}  // namespace elrom::report
