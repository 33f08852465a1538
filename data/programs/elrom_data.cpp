// elrom-data: CFD results into stores, collisions into sets. Each subcommand has its own command_<name>.cpp.

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/version.hpp"
#include "elrom/units/udunits.hpp"

namespace {

int run(int argc, char** argv) {
  elrom::cli::App program("ELROM: prepare CFD results and collisions for training.", "elrom-data");
  program.set_version_flag("--version", elrom::program_version());
  program.require_subcommand(1);
  program.column_width(34);
  elrom::units::use_udunits();
  elrom::programs::Work chosen;
  elrom::programs::add_import(program, chosen);
  elrom::programs::add_inspect(program, chosen);
  elrom::programs::add_check(program, chosen);
  elrom::programs::add_remove(program, chosen);
  elrom::programs::add_watch(program, chosen);
  elrom::programs::add_mesh(program, chosen);
  elrom::programs::add_generate(program, chosen);
  elrom::programs::add_collisions(program, chosen);
  program.footer(
      "Exit status: 0 done, 2 wrong command line, 3 wrong input, 8 nothing new (watch), 1 trouble of the machine, "
      "130 interrupted.");
  if (const auto status = program.parse(argc, argv)) return *status;
  return chosen();
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-data", [&] { return run(argc, argv); });
}
