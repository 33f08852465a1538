// elrom-simulate: spheres in a scene, with the effects that it names.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/comma_list.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/cli/cli.hpp"
#include "elrom/scene/scene_run.hpp"
#include "elrom/units/udunits.hpp"
#if ELROM_HAS_LAMMPS
#include "elrom/lammps/processes.hpp"
#endif

namespace elrom::programs {
namespace {

using Json = nlohmann::ordered_json;

enum class Engine { native, lammps };
constexpr base::EnumNames<Engine, 2> engines{"--engine",
                                             {{Engine::native, "native"}, {Engine::lammps, "lammps"}}};

struct SimulateOptions {
  std::filesystem::path scene, output, json;
  std::vector<std::string> changes;
  std::string engine = "native";
  int threads = base::available_threads();
  bool explain = false, small = false;
};

std::string cost_line(const scene::EffectCost& cost, bool measured) {
  const double bytes = measured ? cost.bytes : cost.bytes_estimated;
  const double seconds = measured ? cost.seconds : cost.seconds_estimated;
  return fmt::format("  {:<28}{:>14} bytes{:>14} s\n", cost.name, base::rounded(bytes),
                     base::rounded(seconds));
}

void explain(const scene::Simulation& simulation, bool measured) {
  fmt::print("{} of {}:\n", measured ? "Measured" : "Effects, estimated", simulation.settings().name);
  for (const auto& cost : simulation.costs()) fmt::print("{}", cost_line(cost, measured));
  if (measured && !simulation.text().empty()) fmt::print("  {}\n", simulation.text());
}

// Of NaN, null.
Json number_or_null(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json json_of_group(const scene::Simulation& simulation, std::size_t group) {
  const auto& tally = simulation.state().tally;
  const auto& residence = tally.residence[group];
  return {
      {"name", simulation.group_names()[group]},
      {"spheres", std::ranges::count(simulation.state().particles.group, static_cast<std::int32_t>(group))},
      {"wall_hits", tally.wall_hits_by_group[group]},
      {"left", residence.number()},
      {"mean_residence_s", number_or_null(residence.mean())},
      {"residence_10_s", number_or_null(residence.quantile(0.1))},
      {"residence_50_s", number_or_null(residence.quantile(0.5))},
      {"residence_90_s", number_or_null(residence.quantile(0.9))}};
}

Json json_of(const scene::Simulation& simulation, const scene::SceneRun& run, int threads) {
  const auto& state = simulation.state();
  const auto& tally = state.tally;
  auto json = io::json_head<Json>(io::kinds::scene_summary);
  json["scene"] = simulation.settings().name;
  json["collision_model"] = simulation.settings().collisions;
  json["time_step_s"] = simulation.settings().time_step;
  json["time_s"] = state.time;
  json["seconds"] = run.seconds;
  json["threads"] = threads;
  json["steps"] = run.steps;
  json["resumed_from"] = run.resumed_from;
  json["spheres"] = state.particles.size();
  json["waiting"] = state.waiting.size();
  json["due"] = simulation.due();
  json["mass_kg"] = mass_of(state.particles);
  json["kinetic_energy_j"] = kinetic_energy_of(state.particles);
  json["collisions"] = tally.collisions;
  json["wall_hits"] = tally.wall_hits;
  json["left"] = tally.left;
  json["returned"] = tally.returned;
  json["skipped_collisions"] = tally.skipped;
  for (std::size_t g = 0; g < simulation.group_names().size(); ++g)
    json["groups"].push_back(json_of_group(simulation, g));
  for (const auto& cost : simulation.costs())
    json["effects"].push_back({{"name", cost.name},
                               {"bytes_estimated", cost.bytes_estimated},
                               {"seconds_estimated", cost.seconds_estimated},
                               {"bytes", cost.bytes},
                               {"seconds", cost.seconds}});
  json["files"] = run.files;
  return json;
}

// A line a group, where spheres can leave.
void report_groups(const scene::Simulation& simulation) {
  const auto& state = simulation.state();
  if (!simulation.domain().has_outlets()) return;
  for (std::size_t g = 0; g < simulation.group_names().size(); ++g) {
    const auto& residence = state.tally.residence[g];
    const auto inside = std::ranges::count(state.particles.group, static_cast<std::int32_t>(g));
    fmt::print("  {}: {} left", simulation.group_names()[g], residence.number());
    if (residence.number() > 0)
      fmt::print(" after {} s on average (a tenth within {} s, half {} s, nine tenths {} s)",
                 base::rounded(residence.mean(), 3), base::rounded(residence.quantile(0.1), 3),
                 base::rounded(residence.quantile(0.5), 3), base::rounded(residence.quantile(0.9), 3));
    fmt::print(", {} inside; {} wall hits\n", inside, state.tally.wall_hits_by_group[g]);
  }
}

void report(const scene::Simulation& simulation, const scene::SceneRun& run, const SimulateOptions& options) {
  const auto& state = simulation.state();
  const double rate = run.seconds > 0 ? static_cast<double>(run.steps) *
                                            static_cast<double>(state.particles.size()) / run.seconds
                                      : 0;
  fmt::print(
      "{} spheres after {} s: {} collisions, {} wall hits{}{}.\n{} steps took {} on {} thread{} ({:.3g} sphere steps/s).\n",
      state.particles.size(), base::number(state.time), state.tally.collisions, state.tally.wall_hits,
      state.tally.left > 0 ? fmt::format(", {} left, {} came back", state.tally.left, state.tally.returned)
                           : "",
      state.tally.skipped > 0
          ? fmt::format("; {} collisions of jammed spheres were skipped", state.tally.skipped)
          : "",
      run.steps, base::duration(run.seconds), options.threads, options.threads == 1 ? "" : "s", rate);
  report_groups(simulation);
  fmt::print("Written: {}\n", options.output.string());
}

scene::SceneSettings settings_of(const SimulateOptions& options) {
  auto settings = scene::read_scene(options.scene, options.changes);
  if (options.small) settings.duration = std::min(settings.duration, 20 * settings.time_step);
  return settings;
}

int simulate(scene::Simulation& simulation, const SimulateOptions& options) {
  if (options.explain) {
    simulation.try_cells();
    explain(simulation, false);
  }
  const auto log = make_console_log();
  const auto done = scene::run(simulation, options.output, *log, base::interrupt_token());
  if (options.explain) explain(simulation, true);
  const auto summary = json_of(simulation, done, options.threads).dump(2) + "\n";
  // Of a run that was whole before, the summary with its time stays.
  const auto kept = options.output / "summary.json";
  if (done.steps > 0 || !std::filesystem::exists(kept)) base::write_text(kept, summary);
  if (!options.json.empty()) base::write_text(options.json, summary);
  report(simulation, done, options);
  return 0;
}

int simulate_alone(const SimulateOptions& options) {
  scene::Simulation simulation(settings_of(options), options.threads);
  return simulate(simulation, options);
}

#if ELROM_HAS_LAMMPS
int simulate_with_lammps(SimulateOptions options) {
  (void)base::interrupt_token();  // before the ranks meet: one that a signal ends would end the others
  lammps::Processes processes;
  options.threads = 1;
  if (processes.rank() > 0) {
    processes.serve();
    return 0;
  }
  const auto settings = settings_of(options);
  scene::Simulation simulation(settings, options.threads, processes.movers(settings));
  return simulate(simulation, options);
}
#else
int simulate_with_lammps(const SimulateOptions&) {
  throw NotBuiltError(Problem{.what = "--engine lammps needs LAMMPS and MPI, which this build left out",
                              .advice = "install liblammps-dev and build again, or run without --engine"});
}
#endif

int run_simulate(int argc, char** argv) {
  SimulateOptions options;
  cli::App app(
      "ELROM: simulate spheres in a scene, with the effects that it names and no others.\nRun again after a crash or Ctrl-C, "
      "the same command goes on from the last checkpoint.",
      "elrom-simulate");
  app.set_version_flag("--version", program_version());
  app.add_option("SCENE", options.scene, "The scene, TOML")->type_name("SCENE.toml")->required();
  app.add_option("--output", options.output, "Folder to write to")->type_name("DIR")->required();
  base::repeatable(app.add_option("--set", options.changes, "Change a setting: effects.collisions=dem"))
      ->type_name("KEY=VALUE");
  app.add_option("--threads", options.threads, "Processor threads; the result does not depend on them")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_option(
         "--engine", options.engine,
         "native, or lammps: in several processes, under mpirun; helscm without inlets, outlets or parcels")
      ->type_name("ENGINE")
      ->capture_default_str();
  app.add_flag("--explain", options.explain,
               "Print what each effect costs, estimated before and measured after");
  app.add_flag("--small", options.small, "At most 20 time steps");
  app.add_option("--json", options.json, "Write what happened to this file too")->type_name("FILE");
  app.footer([] { return "Settings of a scene:\n" + scene::scene_help(); });
  if (const auto status = app.parse(argc, argv)) return *status;
  units::use_udunits();
  return engines.value<UsageError>(options.engine) == Engine::lammps ? simulate_with_lammps(options)
                                                                     : simulate_alone(options);
}

}  // namespace
}  // namespace elrom::programs

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-simulate", [&] { return elrom::programs::run_simulate(argc, argv); });
}
