// The fault campaign as one program; see tests/faults/run.

#include "campaign.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/cli/cli.hpp"
#include "elrom/field/mesh.hpp"
#include "fuzz_inputs.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::faults {
namespace {

struct Section {
  std::string key, what;
  std::function<Tally(const Workshop&)> run;
  [[nodiscard]] bool fuzzes() const { return key == "fuzz" || key == "libfuzzer"; }
};

const std::vector<Section>& sections() {
  static const std::vector<Section> all = {
      {"kills", "kill -9 at random moments of import, training, prediction, starts, collisions", kills},
      {"network_kills", "kill -9 at random moments of networks' training", network_kills},
      {"truncations", "files cut at many lengths are refused by name", truncations},
      {"flipped_bytes", "changed bytes of a bundle are found", flipped_bytes},
      {"unit_mistakes", "slips between units in the shipped cases are caught", unit_mistakes},
      {"hard_cases", "hard data ends in finite numbers or a clear error", hard_cases},
      {"failing_writes", "failing writes leave old or new state", failing_writes},
      {"failing_allocations", "memory that runs out leaves old or new state", failing_allocations},
      {"disk_full", "a full disk leaves old or new state", disk_full},
      {"two_at_once", "two programs on one store or study; readers meanwhile", two_at_once},
      {"fuzz", "hostile bundles, tables, cases and collisions are refused", fuzz_inputs},
      {"libfuzzer", "the same by libFuzzer, with sanitizers and limits of time and memory", fuzz_programs},
  };
  return all;
}

void print(const Section& section, const Tally& tally) {
  if (!tally.skipped.empty()) {
    fmt::print("{:<20}skipped: {}\n", section.key, tally.skipped);
  } else {
    fmt::print("{:<20}{} of {}  {}\n", section.key, tally.passed, tally.of, section.what);
  }
  for (const auto& [library, n] : tally.died_in)
    fmt::print("    {} of them died inside {}, with every file as before or complete\n", n, library);
  for (const auto& failure : tally.failures) fmt::print("    {}\n", failure);
  std::fflush(stdout);
}

/// Unit mistakes may hide in a case's own deviation; all else must pass whole.
bool good_enough(const Section& section, const Tally& tally) {
  constexpr double caught = 0.95;
  if (section.key != "unit_mistakes") return tally.clean();
  return static_cast<double>(tally.passed) >= caught * static_cast<double>(tally.of);
}

int run_campaign(Workshop shop, const std::vector<std::string>& only, const std::string& json) {
  const test::TemporaryFolder folder;
  shop.folder = folder.path();
  field::write_mesh(shop.mesh(), field::make_furnace_mesh({}, 5, 6, 8));
  nlohmann::ordered_json report{{"small", shop.small}};
  bool good = true;
  Tally inputs;
  for (const auto& section : sections()) {
    if (!only.empty() && std::find(only.begin(), only.end(), section.key) == only.end()) continue;
    const auto tally = section.run(shop);
    print(section, tally);
    good = good && good_enough(section, tally);
    report[section.key] = {{"passed", tally.passed}, {"of", tally.of}};
    if (!tally.died_in.empty()) report[section.key]["died_in_library"] = tally.died_in;
    if (!tally.skipped.empty()) report[section.key]["skipped"] = tally.skipped;
    if (section.fuzzes()) inputs.count(tally.passed, tally.of, {});
  }
  if (inputs.of > 0) {
    print({"fuzz_inputs", "of all fuzzers together", {}}, inputs);
    report["fuzz_inputs"] = inputs.passed;
  }
  if (!json.empty()) base::write_text(json, report.dump(2) + "\n");
  return good ? 0 : 1;
}

}  // namespace
}  // namespace elrom::faults

int main(int argc, char** argv) {
  return elrom::base::run_app("fault_campaign", [&] {
    elrom::cli::App app("Faults done to ELROM's programs and files, and how much of it they survive.");
    elrom::faults::Workshop shop;
    shop.programs = ELROM_BIN_DIR;
    shop.preload = ELROM_PRELOAD;
    shop.source = ELROM_SOURCE_DIR;
    shop.fuzzers = shop.source / "build/fuzz/tests";
    std::string json;
    std::vector<std::string> only;
    app.add_flag("--small", shop.small, "A short version: about a minute");
    app.add_option("--fuzz-inputs", shop.n_fuzz,
                   "Inputs for libFuzzer's programs: ten million, 20000 with --small");
    app.add_option("--fuzzers", shop.fuzzers, "Folder of libFuzzer's programs (cmake --preset fuzz)");
    app.add_option("--json", json, "Write the tallies to this file")->type_name("FILE");
    app.add_option("--only", only, "Only these sections (kills, truncations ...)")->delimiter(',');
    if (const auto status = app.parse(argc, argv)) return *status;
    if (shop.n_fuzz == 0) shop.n_fuzz = shop.times(10'000'000, 20'000);
    return elrom::faults::run_campaign(shop, only, json);
  });
}
