// elrom-train: from a snapshot store to a bundle.

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/version.hpp"

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-train", [&] {
    elrom::base::keep_freed_memory();
    elrom::cli::App app("Trains reduced-order models of a furnace from a snapshot store.", "elrom-train");
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
    if (const auto status = app.parse(argc, argv)) return *status;
    return run();
  });
}
