#include "fuzz_inputs.hpp"

#include <algorithm>
#include <ctime>
#include <filesystem>

#include "elrom/base/child_process.hpp"
#include "elrom/base/error.hpp"
#include "fuzz_targets.hpp"
#include "process.hpp"
#include "support/temporary_folder.hpp"

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
    const auto start = std::clock();  // of the processor: tests run beside others
    target.run({reinterpret_cast<const std::uint8_t*>(input.data()), input.size()});
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    if (seconds > most_seconds) throw std::runtime_error("input " + std::to_string(i) + " took too long");
  }
}

/// What one program gets, per thousand inputs that are asked for: that many bundles, most of them tiny (a
/// thousand cost no more than a large one), and texts besides.
struct Share {
  std::string target;
  std::size_t per_thousand;
  std::size_t most_bytes;
};

const std::vector<Share>& shares() {
  static const std::vector<Share> all = {
    {"bundle", 980, 700},
    {"bundle", 20, 12000},
    {"bundle_content", 20, 400},
    {"cases_csv", 15, 1000},
    {"cases_json", 15, 1000},
    {"cases_toml", 10, 1000},
    {"fluent_ascii", 10, 1000},
    {"foam", 10, 1000},
    {"vtu", 10, 2000},
    // Each of their inputs costs a process, since HDF5 is not to be trusted.
    {"collisions", 1, 40000},
    {"collisions_content", 1, 400},
    {"collision_model", 20, 4000},
    {"collision_model_content", 10, 400},
#if ELROM_HAS_SERVE
    {"http_target", 20, 400},
    {"json_body", 20, 2000},
    {"service_request", 10, 1000},
    {"http_wire", 5, 1000},
    {"scenario", 20, 2000},
    {"fields_upload", 1, 40000}
#endif
  };
  return all;
}

/// Inputs that libFuzzer says it tried.
std::size_t tried_inputs(const std::string& output) {
  const std::string mark = "stat::number_of_executed_units:";
  const auto found = output.rfind(mark);
  return found == std::string::npos ? 0 : std::stoul(output.substr(found + mark.size()));
}

std::filesystem::path write_seeds(const std::string& target, const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  int n = 0;
  for (const auto& seed : seeds_of(target)) test::write_bytes(folder / std::to_string(n++), seed);
  return folder;
}

}  // namespace

Tally fuzz_programs(const Workshop& shop) {
  Tally tally;
  for (const auto& share : shares()) {
    const auto program = shop.fuzzers / ("fuzz_" + share.target);
    if (!std::filesystem::exists(program)) {
      tally.skipped = "not built: cmake --preset fuzz && cmake --build --preset fuzz --target fuzz-programs";
      return tally;
    }
    const std::size_t n = shop.n_fuzz * share.per_thousand / 1000;
    const auto harm = std::filesystem::current_path() / ("fuzz-" + share.target + "-");
    const auto folder = shop.folder / ("seeds_" + share.target + std::to_string(share.most_bytes));
    // An input may take a minute of wall-clock time, for the machine may be busy; the program itself counts
    // processor time.
    Process process({program.string(), "-runs=" + std::to_string(n),
                     "-max_len=" + std::to_string(share.most_bytes),
                     "-seed=" + std::to_string(shop.seed.value() % 1'000'000'007), "-timeout=60",
                     "-malloc_limit_mb=64", "-entropic=0", "-reduce_inputs=0", "-print_final_stats=1",
                     "-artifact_prefix=" + harm.string(), write_seeds(share.target, folder).string()});
    const auto exit = process.wait(300 + static_cast<double>(n) / 100);
    const auto n_tried = tried_inputs(exit.output);
    const bool clean = exit.status == 0 && n_tried >= n;
    tally.count(clean ? n : std::min(n_tried, n - 1), n,
                share.target + ": " +
                    exit.output.substr(exit.output.size() - std::min<std::size_t>(exit.output.size(), 2000)));
  }
  return tally;
}

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
