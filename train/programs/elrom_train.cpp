// elrom-train: from a snapshot store to a bundle.

#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/version.hpp"

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-train", [&] {
    CLI::App app("Trains reduced-order models of a furnace from a snapshot store.");
    app.set_version_flag("--version", elrom::program_version());
    app.require_subcommand(1);
    elrom::programs::Work run;
    elrom::programs::add_run(app, run);
    elrom::programs::add_screen(app, run);
    elrom::programs::add_search(app, run);
    elrom::programs::add_fit(app, run);
    elrom::programs::add_retrain(app, run);
    elrom::programs::add_status(app, run);
    elrom::programs::add_versions(app, run);
    elrom::programs::add_collisions(app, run);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : static_cast<int>(elrom::ExitStatus::usage);
    }
    return run();
  });
}
