#pragma once
// Reproducible randomness: every consumer derives its own stream from a name, so adding a consumer changes no
// other. Distributions are written here because the standard leaves theirs to the library's maker.

#include <cstdint>
#include <string_view>
#include <vector>

namespace elrom::base {

/// A named seed: derive("screen").derive("pressure").derive(3) always gives the same stream.
class Seed {
 public:
  explicit Seed(std::uint64_t value) : value_(value) {}
  [[nodiscard]] Seed derive(std::string_view name) const;
  [[nodiscard]] Seed derive(std::uint64_t index) const;
  [[nodiscard]] std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

/// xoshiro256** (Blackman & Vigna 2018); satisfies UniformRandomBitGenerator.
class Random {
 public:
  using result_type = std::uint64_t;
  explicit Random(Seed seed);
  static constexpr result_type min() { return 0; }
  static constexpr result_type max() { return ~result_type{0}; }
  result_type operator()();
  /// Uniform in [0, 1), 53 bits.
  double uniform();
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  /// Standard normal (Marsaglia polar).
  double normal();
  /// Uniform integer in [0, n), without modulo bias; n > 0.
  std::uint64_t below(std::uint64_t n);
  /// Fisher-Yates.
  template <class T>
  void shuffle(std::vector<T>& items) {
    for (std::size_t i = items.size(); i > 1; --i) std::swap(items[i - 1], items[below(i)]);
  }

 private:
  std::uint64_t state_[4];
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace elrom::base
