// bench-search: the search algorithms on real submodels, each with the same number of distinct trials; what
// they end with (mean over the seeds that confirm the winner) and how long they take. The default of
// search.algorithm comes from here.

#include "elrom/networks/search.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "elrom/base/log.hpp"
#include "elrom/field/snapshot_store.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/networks/records.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/study.hpp"
#include "elrom/torch/trainer.hpp"
#include "support/benchmark.hpp"
#include "support/temporary_folder.hpp"

namespace {

using namespace elrom;
using benchmark::Stopwatch;
using Json = nlohmann::ordered_json;

struct Problem {
  std::string name;
  networks::TrainingProblem records;
};

std::filesystem::path shipped_store(const std::filesystem::path& folder) {
  const auto store = folder / "snapshots.h5";
  const std::filesystem::path data(ELROM_SOURCE_DIR "/data");
  std::vector<std::string> arguments{"import", "--mesh", (data / "mesh" / "furnace_20x42x66.h5").string(),
                                     "--store", store.string()};
  for (const auto& entry : std::filesystem::directory_iterator(data / "cases")) {
    if (entry.path().extension() == ".h5") arguments.push_back(entry.path().string());
  }
  benchmark::run_program(benchmark::sibling("elrom-data"), arguments);
  return store;
}

// Every third field, its columns in two halves by the closed-form screen: an easy and a hard submodel.
std::vector<Problem> submodels(const field::SnapshotStore& store, const study::Settings& settings, bool small,
                               Log& log) {
  const auto rows = study::hold_out(store, study::held_out_patterns(store, settings, log));
  const auto cases = study::study_cases(store, settings, rows.building, log);
  const auto part = networks::split_records(cases.loads, cases.mesh.n_planes,
                                            networks::part_rule(settings.split), base::Seed(1));
  std::vector<Problem> problems;
  for (std::size_t f = 0; f < store.fields().size(); f += 3) {
    const field::FieldData data{&cases, store.fields()[f], store.read(store.fields()[f].name, rows.building)};
    const auto set = networks::make_records({data, math::all_rows(cases.n_cases())}, part,
                                            {.encoding = model::PlaneEncodingKind::fourier});
    const auto screening = networks::screen_fast(set.records, settings.screen, {});
    const double middle = math::median(screening.column_error());
    for (const auto& band : networks::make_bands(screening, {.scope = "field", .edges = {middle}})) {
      problems.push_back({data.info.name + ", " + band.name, networks::make_problem(set.records, band)});
    }
    if (small) break;
  }
  return problems;
}

Json measure_algorithm(const std::string& algorithm, const std::vector<Problem>& problems,
                       networks::SearchSettings settings, const networks::Trainer& trainer,
                       const benchmark::Arguments& arguments, Log& log) {
  settings.algorithm = algorithm;
  std::vector<networks::SearchResult> results(problems.size());
  const networks::TrainingBudget budget{settings.max_epochs, settings.patience, 0};
  const Stopwatch watch;
  base::parallel_for(problems.size(), arguments.threads, [&](std::size_t i, int) {
    const auto evaluate = [&](const networks::Hyperparameters& h, base::Seed seed,
                              networks::TrainingMonitor* monitor) {
      return trainer.train(problems[i].records, h, budget, seed, monitor, {});
    };
    results[i] = networks::search(evaluate, settings, networks::SearchSpace(settings),
                                  {.name = algorithm + ", " + problems[i].name,
                                   .digest = {},
                                   .seed = base::Seed(1),
                                   .log = &log,
                                   .stop = {}});
  });
  const double seconds = watch.seconds();
  Json json{{"trials", settings.trials},
            {"best_validation_mse", 0.0},
            {"seconds", seconds},
            {"submodels", Json::object()}};
  double log_sum = 0;
  for (std::size_t i = 0; i < problems.size(); ++i) {
    json["submodels"][problems[i].name] = results[i].validation_mse;
    log_sum += std::log(results[i].validation_mse);
  }
  json["best_validation_mse"] =
      std::exp(log_sum / static_cast<double>(problems.size()));  // geometric: no field outweighs the rest
  return json;
}

Json measure(const benchmark::Arguments& arguments) {
  const test::TemporaryFolder folder;
  const auto store =
      field::SnapshotStore::open(arguments.store.empty() ? shipped_store(folder.path()) : arguments.store);
  const auto log = make_console_log(Level::warning);
  auto settings = study::read_settings({});
  settings.search.trials = arguments.small ? 6 : 30;
  settings.search.max_epochs = arguments.small ? 9 : 40;
  settings.search.confirm = arguments.small ? 2 : 5;
  const auto problems = submodels(store, settings, arguments.small, *log);
  const auto trainer = torch::make_torch_trainer();
  Json algorithms = Json::object();
  for (const auto* algorithm : {"direct", "sobol_bobyqa", "sbplx", "crs2", "random"}) {
    algorithms[algorithm] =
        measure_algorithm(algorithm, problems, settings.search, *trainer, arguments, *log);
    fmt::print(stderr, "{}: {}\n", algorithm, algorithms[algorithm]["best_validation_mse"].get<double>());
  }
  return {{"submodels", problems.size()}, {"threads", arguments.threads}, {"algorithms", algorithms}};
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main("bench-search",
                                          "The algorithms of search.algorithm on submodels of real cases.",
                                          "snapshot store [the shipped cases]", argc, argv, measure);
}
