// bench-pipeline: the whole `elrom-train run` at full size, from `elrom-data generate`: seconds of each
// stage, largest resident memory, a second run that has nothing to do; and what a second thread, or a second
// process, gains for the networks of one field.

#include <fmt/format.h>

#include "elrom/field/snapshot_store.hpp"
#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace elrom;
using benchmark::Stopwatch;
using Json = nlohmann::ordered_json;

struct Run {
  double seconds = 0, rss_gib = 0;
  Json timing;
};

Run train(const std::filesystem::path& study, const std::filesystem::path& store, bool small, int threads) {
  const Stopwatch watch;
  std::vector<std::string> arguments{"run",       study.string(),          "--store", store.string(),
                                     "--threads", std::to_string(threads), "-q"};
  if (small) arguments.insert(arguments.end(), {"--effort", "quick"});
  const auto usage = benchmark::run_program(benchmark::sibling("elrom-train"), arguments);
  return {watch.seconds(), static_cast<double>(usage.ru_maxrss) / (1024.0 * 1024.0),
          Json::parse(base::read_text(study / "timing.json"))};
}

std::filesystem::path generate(const std::filesystem::path& folder, bool small) {
  const auto store = folder / "snapshots.h5";
  benchmark::run_program(benchmark::sibling("elrom-data"),
                         {"generate", "--cases", small ? "20" : "249", "--planes", small ? "6" : "66",
                          "--columns", small ? "40" : "840", "--fields", small ? "2" : "9", "--inputs", "26",
                          "--seed", "1", "--store", store.string()});
  return store;
}

/// Seconds of the networks of one field at quick effort, from nothing. @param launcher empty: one process
double train_networks(const std::filesystem::path& folder, const std::filesystem::path& store, int threads,
                      std::vector<std::string> launcher) {
  std::filesystem::remove_all(folder);
  const auto field = field::SnapshotStore::open(store).fields().front().name;
  launcher.push_back(benchmark::sibling("elrom-train").string());
  for (const auto& argument : {std::string("fit"), folder.string(), std::string("--store"), store.string(),
                               std::string("--threads"), std::to_string(threads), std::string("--effort"),
                               std::string("quick"), std::string("--set"), std::string("method=networks"),
                               std::string("--set"), "fields.names=[\"" + field + "\"]", std::string("-q")})
    launcher.push_back(argument);
  const Stopwatch watch;
  benchmark::run_program(launcher.front(), {launcher.begin() + 1, launcher.end()});
  return watch.seconds();
}

Json scaling(const std::filesystem::path& folder, const std::filesystem::path& store) {
  const auto seconds = [&](int threads, const std::vector<std::string>& launcher) {
    return train_networks(folder / "scaling", store, threads, launcher);
  };
  const double one = seconds(1, {}), threads = seconds(2, {});
  Json json{
      {"one_thread_seconds", one}, {"two_threads_seconds", threads}, {"two_threads_gain", one / threads}};
#ifdef ELROM_MPIEXEC
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 0);
  ::setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 0);
  const double processes = seconds(1, {ELROM_MPIEXEC, "-n", "2"});
  json["two_processes_seconds"] = processes;
  json["two_processes_gain"] = one / processes;
#endif
  return json;
}

Json measure(const benchmark::Arguments& arguments) {
  const test::TemporaryFolder folder;
  const Stopwatch generate_watch;
  const auto store = arguments.store.empty() ? generate(folder.path(), arguments.small)
                                             : std::filesystem::absolute(arguments.store);
  const double generate_seconds = generate_watch.seconds();
  const auto first = train(folder.path() / "study", store, arguments.small, arguments.threads);
  const auto again = train(folder.path() / "study", store, arguments.small, arguments.threads);
  Json json{{"threads", arguments.threads},   {"generate_seconds", generate_seconds},
            {"total_seconds", first.seconds}, {"stages", first.timing["stages"]},
            {"peak_rss_gib", first.rss_gib},  {"second_run_seconds", again.seconds}};
  json["scaling"] = scaling(folder.path(), store);
  return json;
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main("bench-pipeline", "elrom-train run at full size, stage by stage.",
                                          "snapshot store [generated: 249 cases, 9 fields of 66 x 840 cells]",
                                          argc, argv, measure);
}
