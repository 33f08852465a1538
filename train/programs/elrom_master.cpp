// elrom-master: the master code beside ELROM's prediction, its training, or a program that is not ours.
#include <fmt/format.h>
#include <unistd.h>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/comma_list.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/cli/cli.hpp"
#include "elrom/field/mesh.hpp"
#include "elrom/ingest/import_checked.hpp"
#include "elrom/masters/build_work.hpp"
#include "elrom/masters/foreign_program.hpp"
#include "elrom/units/udunits.hpp"

namespace elrom::programs {
namespace {

struct MasterArguments {
  serve::MasterOptions options{.model = "elrom", .worker = "master-" + std::to_string(::getpid())};
  std::filesystem::path bundle, study, program, token_file;
  std::filesystem::path folder = std::filesystem::temp_directory_path();
  masters::CaseOptions door;
  std::string outside = "el3d";
  unsigned enough = 5;
  bool once = false;
};

/// What does the work; the resident model must outlive it.
serve::Master::Work work_of(const MasterArguments& arguments, serve::ResidentModel& model, Log& log) {
  if (!arguments.bundle.empty()) {
    model.look();
    std::vector<std::string> outside;
    if (arguments.outside != "none") outside.push_back(arguments.outside);
    return serve::prediction_work(model, {.folder = arguments.folder, .outside = outside});
  }
  if (!arguments.study.empty()) {
    const auto settings = study::study_settings(arguments.study);
    return masters::build_work({.study = arguments.study,
                                .enough = arguments.enough,
                                .accepted = arguments.door.accepted,
                                .toolbox = {.trainer = make_network_trainer(settings.device)},
                                .folder = arguments.folder},
                               log);
  }
  const auto program = masters::read_foreign_program(arguments.program);
  masters::expect_installed(program);
  if (program.cfd_case) (void)field::read_mesh(arguments.door.mesh);
  return masters::foreign_work({.program = program,
                                .model = arguments.options.model,
                                .door = arguments.door,
                                .folder = arguments.folder},
                               log);
}

/// Nothing is begun that would fail at the end of a run.
void expect_sensible(const MasterArguments& arguments) {
  const int n_given = !arguments.bundle.empty() + !arguments.study.empty() + !arguments.program.empty();
  if (n_given != 1)
    throw UsageError(Problem{.what = "what does the work is not clear",
                             .found = std::to_string(n_given) + " of --bundle, --study, --program",
                             .expected = "one of them"});
  (void)ingest::accepted_kinds(arguments.door.accepted);
  std::filesystem::create_directories(arguments.folder);
}

int run_master(const MasterArguments& arguments) {
  expect_sensible(arguments);
  auto options = arguments.options;
  options.token = base::trim(base::read_text(arguments.token_file));
  const auto stop = base::interrupt_token();
  const auto log = make_console_log(Level::info);
  serve::ResidentModel model(arguments.bundle);
  serve::Master master(options, work_of(arguments, model, *log), *log);
  if (!arguments.once) {
    fmt::print("takes runs of {}\n", options.model);
    std::fflush(stdout);
    master.work(stop);
    return 0;
  }
  std::size_t n_runs = 0;
  while (master.work_once(stop)) ++n_runs;
  fmt::print("{} run{} worked off\n", n_runs, n_runs == 1 ? "" : "s");
  return n_runs > 0 ? 0 : static_cast<int>(ExitStatus::nothing_new);
}

void add_work_options(cli::App& app, MasterArguments& arguments) {
  app.add_option("--bundle", arguments.bundle,
                 "ELROM predicts: a bundle, or a study whose current model answers")
      ->type_name("PATH");
  app.add_option("--outside", arguments.outside,
                 "Who is asked where the guard says outside of the trained range; none: nobody")
      ->type_name("MODEL")
      ->capture_default_str();
  app.add_option("--study", arguments.study, "ELROM learns: the study that takes new cases, through its gate")
      ->type_name("STUDY");
  app.add_option("--enough", arguments.enough, "New cases in its store from which on it is trained")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_option("--program", arguments.program,
                 "A program that is not ours, as this file describes it (data/FORMATS.md, Foreign program)")
      ->type_name("FILE.toml");
  app.add_option("--mesh", arguments.door.mesh, "Reduced mesh, for a program that leaves a CFD case")
      ->type_name("MESH.h5");
  app.add_option("--furnace", arguments.door.furnace,
                 "Furnace description [default: MESH.toml beside the mesh]")
      ->type_name("FURNACE.toml");
  base::comma_list(app.add_option("--accept", arguments.door.accepted,
                                  "Findings on a case that are only told, separated by commas: " +
                                      base::join(ingest::finding_kinds(), ", ")))
      ->type_name("CHECK,...");
  base::comma_list(app.add_option("--then", arguments.options.then,
                                  "Models that are asked for work on the same inputs after each run"))
      ->type_name("MODEL,...");
}

void add_repository_options(cli::App& app, MasterArguments& arguments) {
  app.add_option("MODEL", arguments.options.model, "Whose runs it takes, as they are asked for: elrom")
      ->required();
  app.add_option("--repository", arguments.options.url, "Address of elrom-serve")
      ->type_name("URL")
      ->required();
  app.add_option("--token-file", arguments.token_file, "File that holds a token of the role model")
      ->type_name("FILE")
      ->required();
  app.add_option("--lease", arguments.options.lease_s,
                 "Seconds after which a run returns whose master is dead; renewed while it works")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_option("--authority", arguments.options.client.authority,
                 "Certificate of who vouches for the server, PEM")
      ->type_name("FILE");
  app.add_option("--work", arguments.folder, "Folder for runs on their way")
      ->type_name("DIR")
      ->capture_default_str();
  app.add_flag("--once", arguments.once, "Work off what waits, and end; exit status 8: nothing did");
}

int run(int argc, char** argv) {
  MasterArguments arguments;
  cli::App app(
      "ELROM: takes a model's runs from a repository (elrom-serve), works on them and gives them back. What does\nthe work: "
      "--bundle, --study or --program. Runs are held under a lease: those of a master that dies return.",
      "elrom-master");
  app.set_version_flag("--version", program_version());
  units::use_udunits();
  add_repository_options(app, arguments);
  add_work_options(app, arguments);
  if (const auto status = app.parse(argc, argv)) return *status;
  return run_master(arguments);
}

}  // namespace
}  // namespace elrom::programs

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-master", [&] { return elrom::programs::run(argc, argv); });
}
