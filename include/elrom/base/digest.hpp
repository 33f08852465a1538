#pragma once
// SHA-256 (FIPS 180-4) by OpenSSL's libcrypto and, of several texts at once, by the processor's own
// instructions; lower-case hexadecimal text.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace elrom::base {

class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  Sha256& add(std::span<const std::byte> bytes);
  /// Length-prefixed, so that ("ab", "c") and ("a", "bc") differ.
  Sha256& add(std::string_view text);
  template <class T>
  requires std::is_arithmetic_v<T> Sha256& add_value(T value) {
    return add(std::as_bytes(std::span(&value, 1)));
  }
  /// 64 hexadecimal digits; ends the object's use.
  [[nodiscard]] std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

[[nodiscard]] std::string sha256(std::span<const std::byte> bytes);
/// Digests of several texts in about half the time of one after
/// the other, where the processor has SHA instructions.
[[nodiscard]] std::vector<std::string> sha256_of_each(std::span<const std::span<const std::byte>> texts);
/// @throws InputError when the file cannot be read
[[nodiscard]] std::string sha256_file(const std::filesystem::path& path);

}  // namespace elrom::base
