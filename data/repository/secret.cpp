#include "elrom/repository/secret.hpp"

#include <unistd.h>

#include <array>
#include <span>

#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"

namespace elrom::repository {

std::string random_secret() {
  std::array<unsigned char, 32> bytes{};
  if (::getentropy(bytes.data(), bytes.size()) != 0) throw SystemError("the system has no random numbers");
  constexpr std::string_view digits = "0123456789abcdef";
  std::string text;
  for (const auto byte : bytes) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

std::string secret_hash(std::string_view secret) { return base::sha256(std::as_bytes(std::span(secret))); }

bool same_in_constant_time(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  volatile unsigned char difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference = static_cast<unsigned char>(difference | (a[i] ^ b[i]));
  return difference == 0;
}

}  // namespace elrom::repository
