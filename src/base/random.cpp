#include "elrom/base/random.hpp"

#include <bit>
#include <cmath>

namespace elrom::base {
namespace {

// SplitMix64 (Steele, Lea & Flood 2014): a bijective mixer, also the recommended way to seed xoshiro.
std::uint64_t split_mix(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15ULL);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
  std::uint64_t state = a ^ std::rotl(b, 32) ^ 0xd1b54a32d192ed03ULL;
  split_mix(state);
  state += b;
  return split_mix(state);
}

}  // namespace

Seed Seed::derive(std::string_view name) const {
  std::uint64_t hash = 0xcbf29ce484222325ULL;  // FNV-1a, 64 bit
  for (const char c : name) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return Seed(mix(value_, hash));
}

Seed Seed::derive(std::uint64_t index) const { return Seed(mix(value_, index)); }

Random::Random(Seed seed) {
  std::uint64_t state = seed.value();
  for (auto& word : state_) word = split_mix(state);
}

Random::result_type Random::operator()() {
  const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Random::uniform() { return static_cast<double>((*this)() >> 11) * 0x1.0p-53; }

double Random::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double u, v, s;
  do {
    u = uniform(-1, 1);
    v = uniform(-1, 1);
    s = u * u + v * v;
  } while (s >= 1 || s == 0);
  const double scale = std::sqrt(-2 * std::log(s) / s);
  spare_ = v * scale;
  has_spare_ = true;
  return u * scale;
}

std::uint64_t Random::below(std::uint64_t n) {
  const std::uint64_t limit = max() - max() % n;
  std::uint64_t draw;
  do draw = (*this)();
  while (draw >= limit);
  return draw % n;
}

}  // namespace elrom::base
