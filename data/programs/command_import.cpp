#include <fmt/format.h>

#include <memory>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/comma_list.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "judgement_options.hpp"

namespace elrom::programs {

namespace {

int run_import(const ingest::ImportOptions& options, const JudgementOptions& judgement) {
  const auto log = make_console_log();
  const auto summary = ingest::import_checked(options, judgement.read(), *log, base::interrupt_token());
  fmt::print("{} {} added to {}, which now holds {}\n", summary.added.size(),
             summary.added.size() == 1 ? "case" : "cases", options.store.string(), summary.n_cases);
  if (summary.added.size() == 0) return 0;
  fmt::print("resampling error, to the reduced mesh and back (rms / standard deviation of the field):\n");
  fmt::print("  {:<24}{:>10}{:>10}\n", "field", "mean", "largest");
  for (std::size_t f = 0; f < summary.fields.size(); ++f) {
    fmt::print("  {:<24}{:>10}{:>10}\n", summary.fields[f].name, base::rounded(summary.mean_error[f], 2),
               base::rounded(summary.largest_error[f], 2));
  }
  fmt::print(
      "{} of {} reduced cells lie outside the hull of the CFD's cell centres; values there stay within their "
      "neighbours'\n",
      summary.n_outside, summary.n_cells);
  return 0;
}

}  // namespace

void add_import(cli::App& program, Work& chosen) {
  auto options = std::make_shared<ingest::ImportOptions>();
  options->n_threads = base::available_threads();
  auto* command = program.add_subcommand(
      "import",
      R"(Read CFD results (EL3D exports, Fluent ASCII or CSV tables, OpenFOAM case directories), resample them to the reduced
mesh and append them to a snapshot store. All files are taken or none: the store is replaced whole at the end.)");
  command
      ->add_option("--mesh", options->mesh,
                   "Reduced mesh (see 'elrom-data mesh'); may be left out when the store exists")
      ->type_name("MESH.h5");
  command->add_option("--store", options->store, "Snapshot store to create or to add to")
      ->type_name("STORE.h5")
      ->required();
  command
      ->add_option("--cases", options->cases,
                   "Table of boundary conditions, for formats that carry none; cases are found by name")
      ->type_name("CASES.csv");
  command
      ->add_option(
          "--furnace", options->furnace,
          R"(Furnace description that the store is to carry: openings, mirrors, limits, held-out cases
[default: MESH.toml beside the mesh, where it is there]; on an existing store also without FILE)")
      ->type_name("FURNACE.toml");
  base::comma_list(
      command->add_option("--fields", options->fields,
                          "Fields of a new store, separated by commas [default: the nine standard fields]"))
      ->type_name("NAME,...");
  command->add_option("--threads", options->n_threads, "Processor threads")
      ->capture_default_str()
      ->check(cli::PositiveNumber);
  auto judgement = std::make_shared<JudgementOptions>();
  add_judgement(*command, *judgement);
  command->add_option("FILE", options->files, "CFD results, one a case")->type_name("FILE...");
  command->callback([options, judgement, &chosen] {
    if (options->files.empty() && options->furnace.empty())
      throw UsageError("elrom-data import needs FILE: CFD results, one a case");
    chosen = [options, judgement] { return run_import(*options, *judgement); };
  });
}

}  // namespace elrom::programs
