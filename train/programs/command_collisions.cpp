#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/digest.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/io/file_kind.hpp"
#include "elrom/surrogate/learn.hpp"

namespace elrom::programs {
namespace {

using particle::SurrogateKind;

struct CollisionOptions {
  std::filesystem::path data, low, output, json, trial_file;
  std::string surrogate = "frame", regressor = "chebyshev", device = "cpu";
  surrogate::LearnSettings settings;
  std::uint64_t seed = 1;
  int threads = base::available_threads();
  bool quiet = false;
};

bool grows_trees(const surrogate::LearnSettings& settings) {
  return settings.surrogate == SurrogateKind::document ||
         (settings.surrogate == SurrogateKind::frame &&
          settings.regressor == surrogate::RegressorKind::trees);
}

// The source's two ranges: pairs up to a tenth of the speed get trees of
// their own. Two-particle DEM makes them in less than a second.
particle::CollisionSet slow_pairs(const CollisionOptions& options, const particle::CollisionSet& set,
                                  const std::stop_token& stop) {
  if (!options.low.empty()) return particle::read_collisions(options.low);
  auto protocol = set.protocol;
  protocol.speed = {set.protocol.speed.low / 10, set.protocol.speed.high / 10};
  return make_collisions(protocol, set.law, set.seed + 1, 0, set.size(), {.n_threads = options.threads},
                         set.speed_cap, stop);
}

nlohmann::ordered_json json_of(const surrogate::LearnedCollisions& learned) {
  auto json = io::json_head<nlohmann::ordered_json>(io::kinds::collision_training);
  json["model"] = learned.bundle.model->text();
  json["seconds"] = learned.seconds;
  json["test"] = nlohmann::ordered_json::parse(to_json(learned.errors));
  if (!learned.document) return json;
  const auto range = [](const surrogate::DocumentRange& found) {
    nlohmann::ordered_json hyperparameters;
    networks::for_each_hyperparameter(found.hyperparameters, [&](std::string_view name, auto value) {
      hyperparameters[std::string(name)] = value;
    });
    return nlohmann::ordered_json{{"mae_m_per_s", found.mae},
                                  {"median_relative", found.median_relative},
                                  {"hyperparameters", hyperparameters},
                                  {"rounds", found.rounds}};
  };
  json["full_range"] = range(learned.document->full);
  if (learned.document->low) json["low_range"] = range(*learned.document->low);
  return json;
}

void print(const CollisionOptions& options, const surrogate::LearnedCollisions& learned) {
  const auto& errors = learned.errors;
  fmt::print("{}: {} learned in {}.\n", options.output.string(), learned.bundle.model->text(),
             base::duration(learned.seconds));
  fmt::print(
      "On {} pairs that it never saw, mean absolute errors of u, v, w: {:.4g}, {:.4g}, {:.4g} m/s; of spins, at the "
      "surface: {:.4g} m/s.\n",
      errors.n_pairs, errors.mae[0], errors.mae[1], errors.mae[2], errors.mae_surface);
  fmt::print("Momentum is {}; {}.\n",
             errors.momentum_error < 1e-12
                 ? "conserved to rounding"
                 : fmt::format("changed by {:.2g} of a pair's on average", errors.mean_momentum_error),
             errors.gaining_share == 0
                 ? "no collision gains energy"
                 : fmt::format("{:.1f} % of the collisions gain energy", 100 * errors.gaining_share));
}

int run_collisions(CollisionOptions options) {
  auto& settings = options.settings;
  settings.surrogate = particle::surrogate_names.value<UsageError>(options.surrogate);
  settings.regressor = surrogate::regressor_names.value<UsageError>(options.regressor);
  const auto log = make_console_log(options.quiet ? Level::warning : Level::info);
  const auto stop = base::interrupt_token();
  const auto set = particle::read_collisions(options.data);
  surrogate::LearnTools tools{
      .seed = base::Seed(options.seed), .n_threads = options.threads, .log = log.get(), .stop = stop};
  std::optional<surrogate::TreeStore> store;
  std::optional<particle::CollisionSet> low;
  if (grows_trees(settings)) {
    tools.trees = make_tree_trainer();
    if (options.trial_file.empty()) options.trial_file = options.output.string() + ".trials.sqlite";
    store.emplace(options.trial_file);
    tools.store = &*store;
  } else if (settings.surrogate == SurrogateKind::frame &&
             settings.regressor == surrogate::RegressorKind::network) {
    tools.networks = make_network_trainer(options.device);
  }
  if (settings.surrogate == SurrogateKind::document) low = slow_pairs(options, set, stop);
  auto learned = learn_collisions(set, low ? &*low : nullptr, settings, tools);
  learned.bundle.provenance["collisions"] = base::sha256_file(options.data);
  learned.bundle.write(options.output);
  if (!options.json.empty()) base::write_text(options.json, json_of(learned).dump(2) + "\n");
  print(options, learned);
  return 0;
}

}  // namespace

void add_collisions(cli::App& app, Work& run) {
  auto options = std::make_shared<CollisionOptions>();
  auto* command = app.add_subcommand(
      "collisions", "learn what two colliding spheres do, from a set made by elrom-data collisions");
  const auto add = [&](const char* name, auto& value, const char* type, const char* help) {
    return command->add_option(name, value, help)->type_name(type)->capture_default_str();
  };
  command->add_option("COLLISIONS", options->data, "Set to learn from; its last 5 % judge")->required();
  add("--surrogate", options->surrogate, "NAME",
      "frame: few numbers in the frame of the collision, momentum exact; document: the source's trees on six velocities; "
      "exact: hard spheres in closed form");
  add("--regressor", options->regressor, "NAME", "What learns inside frame: chebyshev, trees, network");
  add("--low", options->low, "FILE",
      "document: a set of slow pairs for trees of their own [default: made here, up to a tenth of the speeds]");
  add("--trials", options->settings.trees.trials, "N", "Trials of the search for the trees' hyperparameters")
      ->check(cli::NonNegativeNumber);
  add("--trial-file", options->trial_file, "FILE",
      "Where trials are kept, so that a search goes on after a crash [default: OUTPUT.trials.sqlite]");
  add("--seed", options->seed, "N", "Seed");
  add("--threads", options->threads, "N", "Processor threads; the result does not depend on them")
      ->check(cli::PositiveNumber);
  add("--device", options->device, "NAME", "Where networks are trained: cpu, cuda");
  command->add_flag("--quiet", options->quiet, "Warnings only");
  command->add_option("--output", options->output, "Model to write; one there is replaced")
      ->type_name("COLLISION.elrom")
      ->required();
  command->add_option("--json", options->json, "Write the errors to this file too")->type_name("FILE");
  command->callback([=, &run] { run = [options] { return run_collisions(*options); }; });
}

}  // namespace elrom::programs
