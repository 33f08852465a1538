// bench-screening: the batched screening at full size, the same networks one
// after another with LibTorch (a sample of columns), and the closed-form screen;
// how long each takes and how often they agree on a column's band.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "elrom/base/log.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/networks/records.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/study.hpp"
#include "sequential_screening.hpp"
#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace elrom;
using benchmark::Stopwatch;
using Json = nlohmann::ordered_json;

struct Totals {
  double seconds = 0, fast_seconds = 0, sequential_seconds = 0, epochs = 0;
  std::size_t networks = 0, sequential_networks = 0, columns = 0;
  double sequential_equal = 0, fast_equal = 0, sequential_columns = 0, sequential_edge = 0;
};

std::filesystem::path generated_store(const benchmark::Arguments& arguments,
                                      const std::filesystem::path& folder) {
  const auto store = folder / "snapshots.h5";
  const bool small = arguments.small;
  benchmark::run_program(benchmark::sibling("elrom-data"),
                         {"generate", "--cases", small ? "40" : "249", "--planes", small ? "12" : "66",
                          "--columns", small ? "120" : "840", "--fields", small ? "3" : "9", "--inputs", "26",
                          "--seed", "1", "--store", store.string()});
  return store;
}

networks::ScreeningData records_of(const field::FieldData& data, const study::Settings& settings) {
  const auto all = math::all_rows(data.cases->n_cases());
  const auto part = networks::split_records(data.cases->loads, data.cases->mesh.n_planes,
                                            networks::part_rule(settings.split), base::Seed(1));
  return networks::make_records({data, all}, part, {}).records;
}

// Columns spread over the bands, so that every band's edge is tried.
std::vector<std::uint32_t> sample_columns(std::size_t n_columns, std::size_t n) {
  std::vector<std::uint32_t> columns;
  for (std::size_t i = 0; i < std::min(n, n_columns); ++i) {
    columns.push_back(static_cast<std::uint32_t>((2 * i + 1) * n_columns / (2 * std::min(n, n_columns))));
  }
  return columns;
}

void compare_sequential(const networks::ScreeningData& records, const study::Settings& settings,
                        base::Seed seed, const networks::ScreeningResult& batched, std::size_t n_sample,
                        Totals& totals) {
  const auto columns = sample_columns(static_cast<std::size_t>(records.targets.cols()), n_sample);
  if (columns.empty()) return;
  const auto sequential = benchmark::screen_sequentially(records, settings.screen, seed, columns);
  const auto ours = batched.column_error(), theirs = sequential.column_error();
  for (std::size_t i = 0; i < columns.size(); ++i) {
    totals.sequential_equal += networks::band_of(ours[columns[i]], settings.bands.edges) ==
                               networks::band_of(theirs[i], settings.bands.edges);
  }
  totals.sequential_columns += static_cast<double>(columns.size());
  totals.sequential_seconds += sequential.seconds;
  totals.sequential_networks += columns.size() * static_cast<std::size_t>(settings.screen.builds);
}

void measure_field(const field::FieldData& data, const study::Settings& settings,
                   const benchmark::Arguments& arguments, std::size_t n_sample, Log& log, Totals& totals) {
  const auto records = records_of(data, settings);
  const auto seed = base::Seed(1).derive(data.info.name);
  const networks::ScreeningContext context{.seed = seed,
                                           .n_threads = arguments.threads,
                                           .log = &log,
                                           .stop = {},
                                           .task = "screen " + data.info.name};
  const Stopwatch batched_watch;
  const auto batched = networks::screen_networks(records, settings.screen, context);
  totals.seconds += batched_watch.seconds();
  const Stopwatch fast_watch;
  const auto fast = networks::screen_fast(records, settings.screen, context);
  totals.fast_seconds += fast_watch.seconds();
  compare_sequential(records, settings, seed, batched, n_sample, totals);
  const auto n_columns = static_cast<std::size_t>(records.targets.cols());
  totals.fast_equal +=
      networks::equal_bands(batched, fast, settings.bands.edges) * static_cast<double>(n_columns);
  totals.columns += n_columns;
  totals.networks += n_columns * static_cast<std::size_t>(settings.screen.builds);
  totals.epochs += batched.mean_epochs * static_cast<double>(n_columns);
}

Json measure(const benchmark::Arguments& arguments) {
  const test::TemporaryFolder folder;
  const auto path = arguments.store.empty() ? generated_store(arguments, folder.path()) : arguments.store;
  const auto store = field::SnapshotStore::open(path);
  auto settings = study::read_settings({});
  if (arguments.small) settings.screen.max_epochs = 15;
  const auto log = make_console_log();
  const auto rows = study::hold_out(store, study::held_out_patterns(store, settings, *log));
  const auto cases = study::study_cases(store, settings, rows.building, *log);
  Totals totals;
  for (const auto& info : store.fields()) {
    const field::FieldData data{&cases, info, store.read(info.name, rows.building)};
    measure_field(data, settings, arguments, arguments.small ? 2 : 5, *log, totals);
  }
  const double batched_each = totals.seconds / static_cast<double>(totals.networks);
  const double sequential_each =
      totals.sequential_seconds / static_cast<double>(std::max<std::size_t>(totals.sequential_networks, 1));
  return {{"cases", cases.n_cases()},
          {"fields", store.fields().size()},
          {"columns", cases.mesh.n_columns},
          {"builds", settings.screen.builds},
          {"networks", totals.networks},
          {"threads", arguments.threads},
          {"seconds", totals.seconds},
          {"mean_epochs", totals.epochs / static_cast<double>(totals.columns)},
          {"sequential_networks", totals.sequential_networks},
          {"sequential_seconds_each", sequential_each},
          {"speedup_vs_sequential", sequential_each / batched_each},
          {"bands_equal_fraction", totals.sequential_equal / std::max(totals.sequential_columns, 1.0)},
          {"fast_seconds", totals.fast_seconds},
          {"fast_bands_equal_fraction", totals.fast_equal / static_cast<double>(totals.columns)}};
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main(
      "bench-screening", "Batched screening against one LibTorch network at a time.",
      "snapshot store [generated: 249 cases, 9 fields of 66 x 840 cells]", argc, argv, measure);
}
