// bench-retrain: what a retraining with a few new cases costs beside training from nothing on the same
// cases, in processor seconds of the whole program, and how well both models do on the held-out cases.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace elrom;
using Json = nlohmann::ordered_json;

double processor_seconds(const rusage& usage) {
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

struct Program {
  std::filesystem::path folder;  // of the store
  int threads = 1;

  [[nodiscard]] double train(const std::string& command, const std::string& study,
                             const std::string& held_out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{command,
                                       (folder / study).string(),
                                       "--store",
                                       (folder / "snapshots.h5").string(),
                                       "--threads",
                                       std::to_string(threads),
                                       "--effort",
                                       "quick",
                                       "-q",
                                       "--set",
                                       "peers.networks=false",
                                       "--set",
                                       "split.held_out=" + held_out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return processor_seconds(benchmark::run_program(benchmark::sibling("elrom-train"), arguments));
  }
};

/// New are eight cases, or two of the generated ones, from all over the range of loads: held out at first.
Json measure(const benchmark::Arguments& arguments) {
  const bool generated = arguments.store.empty();
  const std::string always = generated ? R"("train_004")" : R"("load_*", "rep*")",
                    fresh = generated ? R"("train_008", "train_012")" : R"("train_0?3", "train_000")";
  const test::TemporaryFolder folder;
  const auto store = generated ? benchmark::generate_store(folder.path(), arguments.small)
                               : std::filesystem::absolute(arguments.store);
  if (store != folder / "snapshots.h5") std::filesystem::copy_file(store, folder / "snapshots.h5");
  const Program program{folder.path(), arguments.threads};
  const auto list = [](const std::string& patterns) { return "[" + patterns + "]"; };
  (void)program.train("fit", "study", list(always + ", " + fresh));
  const double warm =
      program.train("retrain", "study", list(always), {"--json", (folder / "retrain.json").string()});
  const double cold = program.train("fit", "from_nothing", list(always));
  const auto report = Json::parse(base::read_text(folder / "retrain.json"));
  return {{"threads", arguments.threads},           {"cases_before", report["cases_before"]},
          {"cases_after", report["cases_after"]},   {"seconds", warm},
          {"seconds_from_nothing", cold},           {"ratio", warm / cold},
          {"error_before", report["error_before"]}, {"error_after", report["error_after"]}};
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main(
      "bench-retrain",
      "elrom-train retrain with a few new cases beside training from nothing (no networks), in processor seconds.",
      "the quickstart's snapshot store, eight of whose 64 cases come later [generated: two of some]", argc,
      argv, measure);
}
