// bench-pipeline: the whole `elrom-train run` at full size, from `elrom-data generate`: seconds of each
// stage, largest resident memory, and a second run that has nothing to do.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "elrom/field/snapshot_store.hpp"
#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace elrom;
using benchmark::Stopwatch;
using Json = nlohmann::ordered_json;

struct TimedTraining {
  double seconds = 0, rss_gib = 0;
  Json timing;
};

TimedTraining train(const std::filesystem::path& study, const std::filesystem::path& store, bool small,
                    int threads) {
  const Stopwatch watch;
  std::vector<std::string> arguments{"run",       study.string(),          "--store", store.string(),
                                     "--threads", std::to_string(threads), "-q"};
  if (small) arguments.insert(arguments.end(), {"--effort", "quick"});
  const auto usage = benchmark::run_program(benchmark::sibling("elrom-train"), arguments);
  return {watch.seconds(), static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0),
          Json::parse(base::read_text(study / "timing.json"))};
}

Json measure(const benchmark::Arguments& arguments) {
  const test::TemporaryFolder folder;
  const Stopwatch generate_watch;
  const auto store = arguments.store.empty() ? benchmark::generate_store(folder.path(), arguments.small)
                                             : std::filesystem::absolute(arguments.store);
  const double generate_seconds = generate_watch.seconds();
  const auto first = train(folder.path() / "study", store, arguments.small, arguments.threads);
  const auto again = train(folder.path() / "study", store, arguments.small, arguments.threads);
  return {{"threads", arguments.threads},   {"generate_seconds", generate_seconds},
          {"total_seconds", first.seconds}, {"stages", first.timing["stages"]},
          {"peak_rss_gib", first.rss_gib},  {"second_run_seconds", again.seconds}};
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main("bench-pipeline", "elrom-train run at full size, stage by stage.",
                                          "snapshot store [generated: 249 cases, 9 fields of 66 x 840 cells]",
                                          argc, argv, measure);
}
