#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/ingest/generate.hpp"

namespace elrom::programs {

namespace {

int run_generate(const ingest::GenerateOptions& options) {
  const auto log = make_console_log();
  ingest::generate(options, *log, base::interrupt_token());
  fmt::print("{}: {} cases, {} planes x {} columns, {} fields, {} inputs\n", options.store.string(),
             options.n_cases + options.n_held_out, options.n_planes, options.n_columns, options.n_fields,
             options.n_inputs);
  return 0;
}

}  // namespace

void add_generate(cli::App& program, Work& chosen) {
  auto options = std::make_shared<ingest::GenerateOptions>();
  auto small = std::make_shared<bool>(false);
  options->n_threads = base::available_threads();
  auto* command = program.add_subcommand(
      "generate",
      R"(Make a store of any size from a seeded generator with the shape of a real furnace's fields: for benchmarks and tests
of size and speed, never for claims of accuracy.)");
  const auto add = [&](const char* name, auto& value, const char* help) {
    return command->add_option(name, value, help)->capture_default_str();
  };
  auto* cases = add("--cases", options->n_cases, "Cases to train on, named train_000, ...");
  add("--held-out", options->n_held_out, "Further cases at evenly spread loads, named load_042, ...");
  auto* planes = add("--planes", options->n_planes, "Horizontal planes");
  auto* columns = add("--columns", options->n_columns, "Cells of a plane");
  add("--fields", options->n_fields,
      "Fields; fewer than nine are the first of the standard ones, more are tracers");
  add("--inputs", options->n_inputs, "Boundary conditions; more than 26 are auxiliary inlets");
  add("--noise", options->noise, "Noise, as a share of a field's scale");
  add("--seed", options->seed, "Seed");
  add("--threads", options->n_threads, "Processor threads; the result does not depend on them")
      ->check(cli::PositiveNumber);
  command->add_flag("--small", *small, "24 cases of 12 planes x 60 columns, unless given");
  command->add_option("--store", options->store, "Store to write; must not exist")
      ->type_name("STORE.h5")
      ->required();
  command->callback([=, &chosen] {
    if (*small && cases->count() == 0) options->n_cases = 24;
    if (*small && planes->count() == 0) options->n_planes = 12;
    if (*small && columns->count() == 0) options->n_columns = 60;
    chosen = [options] { return run_generate(*options); };
  });
}

}  // namespace elrom::programs
