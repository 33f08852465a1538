// bench-retrain: what a retraining with a few new cases costs beside training from nothing on the same cases,
// in processor seconds of the whole program, and how well both models do on the held-out cases.

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
  std::vector<std::string> settings;  // key=value

  [[nodiscard]] double train(const std::string& command, const std::string& study,
                             const std::string& held_out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> arguments{
        command,     (folder / study).string(), "--store",  (folder / "snapshots.h5").string(),
        "--threads", std::to_string(threads),   "--effort", "quick",
        "-q"};
    auto all = settings;
    all.push_back("split.held_out=" + held_out);
    for (const auto& setting : all) arguments.insert(arguments.end(), {"--set", setting});
    arguments.insert(arguments.end(), more.begin(), more.end());
    return processor_seconds(benchmark::run_program(benchmark::sibling("elrom-train"), arguments));
  }
};

/// New are eight cases, or two of the generated ones, from all over the range of loads: held out at first.
Json measure_one(const Program& program, bool generated) {
  const std::string always = generated ? R"("train_004")" : R"("load_*", "rep*")",
                    fresh = generated ? R"("train_008", "train_012")" : R"("train_0?3", "train_000")";
  const auto list = [](const std::string& patterns) { return "[" + patterns + "]"; };
  const auto named = [&](const std::string& name) { return (program.folder / name).string(); };
  (void)program.train("fit", "study", list(always + ", " + fresh));
  const double warm = program.train("retrain", "study", list(always), {"--json", named("retrain.json")});
  const double cold = program.train("fit", "from_nothing", list(always));
  const auto report = Json::parse(base::read_text(named("retrain.json")));
  benchmark::run_program(benchmark::sibling("elrom-report"),
                         {"accuracy", named("from_nothing"), "--quiet", "--json", named("cold.json")});
  const auto cold_report = Json::parse(base::read_text(named("cold.json")));
  for (const auto* study : {"study", "from_nothing"}) std::filesystem::remove_all(named(study));
  return {{"cases_before", report["cases_before"]},
          {"cases_after", report["cases_after"]},
          {"seconds", warm},
          {"seconds_from_nothing", cold},
          {"ratio", warm / cold},
          {"error_before", report["error_before"]},
          {"error_after", report["error_after"]},
          {"error_from_nothing", cold_report["mean_nrmse"]}};
}

Json measure(const benchmark::Arguments& arguments) {
  const bool generated = arguments.store.empty();
  const test::TemporaryFolder folder;
  const auto store = generated ? benchmark::generate_store(folder.path(), arguments.small)
                               : std::filesystem::absolute(arguments.store);
  if (store != folder / "snapshots.h5") std::filesystem::copy_file(store, folder / "snapshots.h5");
  const auto with = [&](std::vector<std::string> settings) {
    return measure_one({folder.path(), arguments.threads, std::move(settings)}, generated);
  };
  const auto* some = generated ? R"(["solid_velocity_x"])" : R"(["pressure", "gas_velocity_z"])";
  Json all{{"threads", arguments.threads}};
  all["without networks"] = with({"peers.networks=false"});
  all["networks in the contest"] = with({});
  all["networks alone"] = with({"method=networks", std::string("fields.names=") + some});
  return all;
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::benchmark::benchmark_main(
      "bench-retrain",
      "elrom-train retrain with a few new cases beside training from nothing, in processor seconds: without networks, "
      "with them among the candidates, with them alone (pressure and gas velocity z).",
      "the quickstart's snapshot store, eight of whose 64 cases come later [generated: two of some]", argc,
      argv, measure);
}
