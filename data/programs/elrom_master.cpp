// elrom-master: the master code beside a model; so far beside elrom-predict's.
#include <fmt/format.h>
#include <unistd.h>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/cli/cli.hpp"
#include "elrom/serve/master.hpp"

namespace elrom::programs {
namespace {

struct MasterArguments {
  serve::MasterOptions options{.model = "elrom", .worker = "master-" + std::to_string(::getpid())};
  std::filesystem::path bundle, token_file;
  std::filesystem::path folder = std::filesystem::temp_directory_path();
  bool once = false;
};

int run_master(const MasterArguments& arguments) {
  auto options = arguments.options;
  options.token = base::trim(base::read_text(arguments.token_file));
  const auto stop = base::interrupt_token();
  const auto log = make_console_log(Level::detail);
  serve::ResidentModel model(arguments.bundle);
  model.look();
  serve::Master master(options, serve::prediction_work(model, arguments.folder), *log);
  if (!arguments.once) {
    master.work(stop);
    return 0;
  }
  std::size_t n_runs = 0;
  while (master.work_once(stop)) ++n_runs;
  fmt::print("{} run{} worked off\n", n_runs, n_runs == 1 ? "" : "s");
  return n_runs > 0 ? 0 : static_cast<int>(ExitStatus::nothing_new);
}

int run(int argc, char** argv) {
  MasterArguments arguments;
  cli::App app(
      "ELROM: takes runs from a repository (elrom-serve), predicts their fields and gives them back.\nRuns are held under a "
      "lease: those of a master that dies return.",
      "elrom-master");
  app.set_version_flag("--version", program_version());
  app.add_option("MODEL", arguments.options.model, "Whose runs it takes, as they are asked for: elrom")
      ->required();
  app.add_option("--repository", arguments.options.url, "Address of elrom-serve")
      ->type_name("URL")
      ->required();
  app.add_option("--token-file", arguments.token_file, "File that holds a token of the role model")
      ->type_name("FILE")
      ->required();
  app.add_option("--bundle", arguments.bundle, "Bundle, or study whose current model answers")
      ->type_name("PATH")
      ->required();
  app.add_option("--lease", arguments.options.lease_s,
                 "Seconds after which a run returns that nobody gave back")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_option("--authority", arguments.options.client.authority,
                 "Certificate of who vouches for the server, PEM")
      ->type_name("FILE");
  app.add_flag("--once", arguments.once, "Work off what waits, and end; exit status 8: nothing did");
  if (const auto status = app.parse(argc, argv)) return *status;
  return run_master(arguments);
}

}  // namespace
}  // namespace elrom::programs

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-master", [&] { return elrom::programs::run(argc, argv); });
}
