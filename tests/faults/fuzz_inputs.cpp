#include "fuzz_inputs.hpp"

#include <chrono>

#include "elrom/base/child_process.hpp"
#include "elrom/base/error.hpp"
#include "fuzz_targets.hpp"

namespace elrom::faults {
namespace {

constexpr double most_seconds = 1;  // an input may cost

std::string changed(std::string text, base::Random& random) {
  static const std::vector<std::string> hard = {
      "nan", "1e999", "-1", "99999999999999999999", "(", "{", "\"", "[", "\0", "1e-320"};
  for (std::uint64_t n = 1 + random.below(4); n > 0 && !text.empty(); --n) {
    const auto at = random.below(text.size());
    switch (random.below(6)) {
      case 0:
        text[at] = static_cast<char>(random.below(256));
        break;
      case 1:
        text[at] = static_cast<char>(text[at] ^ (1 << random.below(8)));
        break;
      case 2:
        text.resize(at);
        break;
      case 3:
        text.erase(at, 1 + random.below(16));
        break;
      case 4:
        text.insert(at, hard[random.below(hard.size())]);
        break;
      default:
        text.insert(at, text.substr(random.below(text.size()), 1 + random.below(64)));
    }
  }
  return text;
}

/// Runs inputs [begin, end) of a target; what they are follows from the seed alone.
void run_inputs(const FuzzTarget& target, const std::vector<std::string>& seeds, base::Seed seed,
                std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    base::Random random(seed.derive(i));
    const auto input = changed(seeds[random.below(seeds.size())], random);
    const auto start = std::chrono::steady_clock::now();
    target.run({reinterpret_cast<const std::uint8_t*>(input.data()), input.size()});
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (seconds > most_seconds) throw std::runtime_error("input " + std::to_string(i) + " took too long");
  }
}

}  // namespace

Tally fuzz_inputs(const Workshop& shop) {
  Tally tally;
  for (const auto& target : fuzz_targets()) {
    const auto seeds = seeds_of(target.name);
    const auto seed = shop.seed.derive("fuzz").derive(target.name);
    // Inputs go in blocks, each in a child of its own: a crash is told with the block that holds it.
    const std::size_t n_inputs = shop.times(100000, 300), block = 100;
    for (std::size_t begin = 0; begin < n_inputs; begin += block) {
      std::string failure;
      try {
        base::try_in_child(target.name, "inputs from " + std::to_string(begin),
                           [&] { run_inputs(target, seeds, seed, begin, begin + block); },
                           {.seconds = 120, .memory_bytes = std::size_t{512} << 20});
      } catch (const Error& error) {
        failure = error.what();
      }
      for (std::size_t i = 0; i < block; ++i)
        tally.count(failure.empty() || i > 0, target.name + ": " + failure);
    }
  }
  return tally;
}

}  // namespace elrom::faults
