// The one-shot SHA256_* functions are marked old in OpenSSL 3, in favour of EVP, which loads providers and
// costs milliseconds at the start of a program that has thirty; they are the same code underneath.
#define OPENSSL_SUPPRESS_DEPRECATED
#include "elrom/base/digest.hpp"

#include <openssl/sha.h>

#include <array>
#include <fstream>
#include <vector>

#include "elrom/base/error.hpp"
#include "sha256_lanes.hpp"

namespace elrom::base {

namespace {

std::string hexadecimal(std::span<const unsigned char> digest) {
  constexpr char digits[] = "0123456789abcdef";
  std::string text;
  text.reserve(2 * digest.size());
  for (const unsigned char byte : digest) {
    text += digits[byte >> 4];
    text += digits[byte & 15];
  }
  return text;
}

std::string hexadecimal(const Sha256Words& words) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  for (std::size_t i = 0; i < digest.size(); ++i)
    digest[i] = static_cast<unsigned char>(words[i / 4] >> (24 - 8 * (i % 4)));
  return hexadecimal(digest);
}

}  // namespace

struct Sha256::State {
  SHA256_CTX context;
};

Sha256::Sha256() : state_(std::make_unique<State>()) { SHA256_Init(&state_->context); }
Sha256::~Sha256() = default;

Sha256& Sha256::add(std::span<const std::byte> bytes) {
  SHA256_Update(&state_->context, bytes.data(), bytes.size());
  return *this;
}

Sha256& Sha256::add(std::string_view text) {
  add_value(static_cast<std::uint64_t>(text.size()));
  return add(std::as_bytes(std::span(text)));
}

std::string Sha256::hex() {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
  SHA256_Final(digest.data(), &state_->context);
  return hexadecimal(digest);
}

std::string sha256(std::span<const std::byte> bytes) { return Sha256().add(bytes).hex(); }

std::vector<std::string> sha256_of_each(std::span<const std::span<const std::byte>> texts) {
  std::vector<std::string> digests;
  digests.reserve(texts.size());
  if (has_sha_instructions()) {
    for (const auto& words : sha256_in_lanes(texts)) digests.push_back(hexadecimal(words));
  } else {
    for (const auto& text : texts) digests.push_back(sha256(text));
  }
  return digests;
}

std::string sha256_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError({.what = "cannot read file", .where = path.string()});
  Sha256 hash;
  std::vector<char> buffer(1 << 20);
  while (file.read(buffer.data(), static_cast<std::streamsize>(buffer.size())) || file.gcount() > 0) {
    hash.add(std::as_bytes(std::span(buffer.data(), static_cast<std::size_t>(file.gcount()))));
  }
  if (file.bad()) throw InputError({.what = "cannot read file", .where = path.string()});
  return hash.hex();
}

}  // namespace elrom::base
