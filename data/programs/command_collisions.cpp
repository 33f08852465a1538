#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>

#include "collision_words.hpp"
#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/particle/collision_job.hpp"

namespace elrom::programs {

namespace {

/// As typed; empty: not given.
struct CollisionOptions {
  std::string protocol = "general", law = "linear", speed = "0:20 m/s";
  std::string diameter_1 = "315 um", diameter_2, density_1 = "1000 kg/m3", density_2, spin, approach_time;
  std::string restitution = "0.9", friction = "0", tangential_restitution, stiffness, youngs_modulus,
              poisson_ratio;
  std::string speed_cap;
  std::filesystem::path output, json;
  particle::CollisionJob job;
};

/// A mistake in a value is one of the command line, and told with the option's name.
template <class Read>
auto read(const char* option, const Read& value) {
  try {
    return value();
  } catch (const InputError& error) {
    throw UsageError(std::string(option) + ": " + error.what());
  }
}

double number(const char* option, const std::string& text, const char* si) {
  return read(option, [&] { return base::quantity(text, si); });
}

std::optional<double> optional_number(const char* option, const std::string& text, const char* si) {
  return text.empty() ? std::nullopt : std::optional(number(option, text, si));
}

particle::Range range(const char* option, const std::string& text, const char* si) {
  const auto [low, high] = read(option, [&] { return base::interval(text, si); });
  return {low, high};
}

void expect_law(const char* option, const std::string& text, const particle::ContactLaw& law,
                particle::LawKind kind) {
  if (text.empty() || law.kind == kind) return;
  throw UsageError({.what = std::string(option) + " does not belong to this contact law",
                    .found = std::string(particle::law_names.name(law.kind)),
                    .expected = "--law " + std::string(particle::law_names.name(kind))});
}

particle::Protocol protocol_of(const CollisionOptions& options) {
  const auto& or_first = [](const std::string& second, const std::string& first) {
    return second.empty() ? first : second;
  };
  particle::Protocol protocol;
  protocol.kind = particle::protocol_names.value<UsageError>(options.protocol);
  protocol.speed = range("--speed", options.speed, "m/s");
  protocol.diameter_1 = range("--diameter", options.diameter_1, "m");
  protocol.diameter_2 = range("--diameter-b", or_first(options.diameter_2, options.diameter_1), "m");
  protocol.density_1 = number("--density", options.density_1, "kg/m3");
  protocol.density_2 = number("--density-b", or_first(options.density_2, options.density_1), "kg/m3");
  protocol.spin_speed = optional_number("--spin", options.spin, "m/s").value_or(0);
  protocol.approach_time = optional_number("--approach-time", options.approach_time, "s");
  return protocol;
}

constexpr double overlap_share = 0.01;

/// At which no pair overlaps by more than that share. The largest spheres of both ranges, or a large one on a
/// small one, ask for most.
double default_stiffness(const particle::Protocol& protocol) {
  protocol.check();
  double stiffness = 0;
  for (const double one : {protocol.diameter_1.low, protocol.diameter_1.high})
    for (const double two : {protocol.diameter_2.low, protocol.diameter_2.high})
      stiffness = std::max(
          stiffness, particle::stiffness_for_overlap(overlap_share, 2 * protocol.speed.high,
                                                     {one, protocol.density_1}, {two, protocol.density_2}));
  return stiffness;
}

particle::ContactLaw law_of(const CollisionOptions& options, const particle::Protocol& protocol) {
  using particle::LawKind;
  particle::ContactLaw law;
  law.kind = particle::law_names.value<UsageError>(options.law);
  expect_law("--stiffness", options.stiffness, law, LawKind::linear);
  expect_law("--tangential-restitution", options.tangential_restitution, law, LawKind::linear);
  expect_law("--youngs-modulus", options.youngs_modulus, law, LawKind::hertz);
  expect_law("--poisson", options.poisson_ratio, law, LawKind::hertz);
  law.restitution = number("--restitution", options.restitution, "1");
  law.friction = number("--friction", options.friction, "1");
  law.tangential_restitution =
      optional_number("--tangential-restitution", options.tangential_restitution, "1");
  law.youngs_modulus =
      optional_number("--youngs-modulus", options.youngs_modulus, "Pa").value_or(law.youngs_modulus);
  law.poisson_ratio = optional_number("--poisson", options.poisson_ratio, "1").value_or(law.poisson_ratio);
  if (const auto given = optional_number("--stiffness", options.stiffness, "N/m"))
    law.stiffness = *given;
  else if (law.kind == LawKind::linear)
    law.stiffness = default_stiffness(protocol);
  return law;
}

std::string files_of(const CollisionOptions& options) {
  const auto megabytes = static_cast<double>(std::filesystem::file_size(options.output)) / 1e6;
  return fmt::format("{} ({:.3g} MB)", options.output.string(), megabytes) +
         (options.json.empty() ? "" : " and " + options.json.string());
}

int run_collisions(CollisionOptions options) {
  auto& job = options.job;
  job.protocol = protocol_of(options);
  job.law = law_of(options, job.protocol);
  job.speed_cap = optional_number("--speed-cap", options.speed_cap, "m/s");
  job.check();
  const auto log = make_console_log();
  if (job.law.kind == particle::LawKind::linear && options.stiffness.empty())
    log->info(
        fmt::format("stiffness {:.4g} N/m: the fastest head-on pair overlaps by {:.0f} % of its "
                    "smaller diameter at most",
                    job.law.stiffness, 100 * overlap_share));
  const std::map<std::string, std::string> provenance{
      {"steps_per_contact", std::to_string(job.options.steps_per_contact)}};
  const auto run =
      particle::make_collision_file(options.output, job, provenance, *log, base::interrupt_token());
  auto description = describe_collisions(run.set);
  const auto n_computed = static_cast<double>(job.n_pairs - run.n_reused);
  const double rate = run.seconds > 0 ? n_computed / run.seconds : 0;
  if (!options.json.empty()) {
    auto json = io::json_head<nlohmann::ordered_json>(io::kinds::collision_summary);
    description.erase("kind");
    json.update(description);
    json["seconds"] = run.seconds;
    json["pairs_per_second"] = rate > 0 ? nlohmann::ordered_json(rate) : nlohmann::ordered_json(nullptr);
    json["reused_pairs"] = run.n_reused;
    json["threads"] = job.options.n_threads;
    json["files"] = {options.output.string()};
    base::write_text(options.json, json.dump(2) + "\n");
  }
  fmt::print("{} pairs by protocol {} ({}): {}.\nThey took {} on {} {}{}{}.\nWritten: {}\n", job.n_pairs,
             particle::protocol_names.name(job.protocol.kind), job.law.text(),
             energy_words(description["energy_lost"].get<double>()), base::duration(run.seconds),
             job.options.n_threads, job.options.n_threads == 1 ? "thread" : "threads",
             rate > 0 ? fmt::format(", {:.3g} pairs/s", rate) : "",
             run.n_reused > 0 ? fmt::format("; {} pairs were done before", run.n_reused) : "",
             files_of(options));
  return 0;
}

}  // namespace

void add_collisions(cli::App& program, Work& chosen) {
  auto options = std::make_shared<CollisionOptions>();
  auto small = std::make_shared<bool>(false);
  auto& job = options->job;
  job.options.n_threads = base::available_threads();
  auto* command = program.add_subcommand(
      "collisions",
      "Collide pairs of spheres by a two-particle DEM and keep what came out: what elrom-train collisions "
      "learns from.\nQuantities take units (\"315 um\", 315um, \"1 mm\"), ranges too (300:354um); without a "
      "unit they are in SI.\nRun again after a crash or Ctrl-C, the same command goes on from there.");
  const auto add = [&](const char* name, auto& value, const char* type, const char* help) {
    return command->add_option(name, value, help)->type_name(type)->capture_default_str();
  };
  add("--protocol", options->protocol, "NAME",
      "document: the source's, every pair central, both aimed at one point; general: any impact point, "
      "spins");
  auto* pairs = add("--pairs", job.n_pairs, "N", "Pairs");
  add("--speed", options->speed, "RANGE", "Speeds of each sphere");
  add("--diameter", options->diameter_1, "RANGE", "Diameter of sphere 1, one value or a range");
  add("--diameter-b", options->diameter_2, "RANGE", "Diameter of sphere 2 [default: as sphere 1]");
  add("--density", options->density_1, "DENSITY", "Density of sphere 1");
  add("--density-b", options->density_2, "DENSITY", "Density of sphere 2 [default: as sphere 1]");
  add("--spin", options->spin, "SPEED",
      "Greatest surface speed of a sphere's spin, protocol general [default: none]");
  add("--approach-time", options->approach_time, "TIME",
      "Start so long before the spheres would meet, slow pairs overlapped, as the source did; protocol "
      "document [default: as they touch]");
  add("--law", options->law, "NAME", "Contact law: linear, hertz");
  add("--restitution", options->restitution, "E", "Coefficient of restitution");
  add("--friction", options->friction, "MU", "Coefficient of friction");
  add("--tangential-restitution", options->tangential_restitution, "E",
      "Of a contact that sticks, law linear [default: as --restitution]");
  add("--stiffness", options->stiffness, "STIFFNESS",
      "Law linear [default: the fastest head-on pair overlaps by 1 % of the smaller diameter]");
  add("--youngs-modulus", options->youngs_modulus, "PRESSURE", "Law hertz [default: 1 GPa]");
  add("--poisson", options->poisson_ratio, "NU", "Poisson's ratio, law hertz [default: 0.3]");
  add("--speed-cap", options->speed_cap, "SPEED",
      "Cut velocities after the contact to this, as the source did (100 m/s) [default: not]");
  add("--steps-per-contact", job.options.steps_per_contact, "N", "Steps of a contact")
      ->check(cli::Range(4, 100000));
  add("--seed", job.seed, "N", "Seed");
  add("--threads", job.options.n_threads, "N", "Processor threads; the result does not depend on them")
      ->check(cli::PositiveNumber);
  command->add_flag("--small", *small, "2000 pairs, unless given");
  command->add_option("--output", options->output, "File to write; one there is replaced")
      ->type_name("COLLISIONS.h5")
      ->required();
  command->add_option("--json", options->json, "Write what was made to this file too")->type_name("FILE");
  command->callback([=, &chosen] {
    if (*small && pairs->count() == 0) options->job.n_pairs = 2000;
    chosen = [options] { return run_collisions(*options); };
  });
}

}  // namespace elrom::programs
