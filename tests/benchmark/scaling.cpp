// bench-scaling: what a second thread, or a second process (mpirun), gains for the networks of one field at
// full size: screening, search and builds, from nothing each time.

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "elrom/field/snapshot_store.hpp"
#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace elrom;
using benchmark::Stopwatch;
using Json = nlohmann::ordered_json;

/// Seconds of the networks of one field at quick effort. @param launcher empty: one process
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
  const auto store = arguments.store.empty() ? benchmark::generate_store(folder.path(), arguments.small)
                                             : std::filesystem::absolute(arguments.store);
  return scaling(folder.path(), store);
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main("bench-scaling", "One thread, two threads, two processes.",
                                          "snapshot store [generated: 249 cases, 9 fields of 66 x 840 cells]",
                                          argc, argv, measure);
}
