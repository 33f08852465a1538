// elrom-serve: the repository and the resident predictor, by REST.
#include <fmt/format.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <thread>

#include "elrom/base/app.hpp"
#include "elrom/base/log.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/version.hpp"
#include "elrom/cli/cli.hpp"
#include "elrom/ingest/judge_fields.hpp"
#include "elrom/repository/backup.hpp"
#include "elrom/repository/rules.hpp"
#include "elrom/serve/service.hpp"

namespace elrom::programs {
namespace {

struct ServeOptions {
  std::filesystem::path data, model, page, openfoam_case, certificate, key, judged, backup, restored;
  std::string database = "sqlite", address = "127.0.0.1", new_token, anonymous;
  int port = 8080;
  http::Limits limits;
  bool quiet = false;
};

repository::RepositoryOptions repository_options(const ServeOptions& options) {
  return {.folder = options.data, .database = options.database};
}

int print(const repository::Copied& copied, const char* what) {
  fmt::print("{}: {} rows, {} files of fields, {:.1f} MB\n", what, copied.rows, copied.files,
             1e-6 * static_cast<double>(copied.bytes));
  return 0;
}

/// "NAME=ROLE"
int make_token(const ServeOptions& options) {
  const auto parts = base::split(options.new_token, '=');
  if (parts.size() != 2)
    throw UsageError(
        Problem{.what = "no new token", .found = "'" + options.new_token + "'", .expected = "NAME=ROLE"});
  const auto role = repository::roles.value<UsageError>(parts[1]);
  repository::Repository repository(repository_options(options));
  repository.write([&](repository::Transaction& transaction) {
    fmt::print("{}\n", transaction.make_token(parts[0], role));
  });
  return 0;
}

/// The file is a stranger's: this process may crash or be stopped by its limits, and no other is hurt.
int judge(const ServeOptions& options) {
  constexpr rlim_t seconds = 50;
  const rlimit time{seconds, seconds};
  ::setrlimit(RLIMIT_CPU, &time);
  if (options.model.empty()) {
    repository::judge_fields(options.judged, "");
    return 0;
  }
  const model::BundleReader bundle(options.model);
  repository::judge_fields(options.judged, bundle.mesh_digest());
  ingest::judge_physics_of(options.judged, bundle.mesh({.with_corners = false}), bundle.furnace());
  return 0;
}

/// Beside the program where it is installed, or where it was built.
std::filesystem::path found_page(const std::filesystem::path& prefix) {
  for (const char* place : {"share/elrom/page", "page"})
    if (std::filesystem::exists(prefix / place / "index.html")) return prefix / place;
  return {};
}

serve::ServiceOptions service_options(const ServeOptions& options) {
  const auto program = std::filesystem::read_symlink("/proc/self/exe");
  const auto beside = [&](const char* name) {
    const auto file = program.parent_path() / name;
    return std::filesystem::exists(file) ? file : std::filesystem::path();
  };
  serve::ServiceOptions service{
      .repository = repository_options(options),
      .model = options.model.empty() ? options.data / "study" : options.model,
      .page = options.page.empty() ? found_page(program.parent_path().parent_path()) : options.page,
      .predict_program = beside("elrom-predict"),
      .report_program = beside("elrom-report"),
      .openfoam_case = options.openfoam_case,
      .judge_upload = [program](const std::filesystem::path& file, const std::filesystem::path& bundle) {
        serve::judge_in_process(program, file, bundle);
      }};
  if (!options.anonymous.empty()) service.anonymous = repository::roles.value<UsageError>(options.anonymous);
  if (!options.quiet)
    service.log = [](const std::string& line) { std::fputs((line + "\n").c_str(), stderr); };
  return service;
}

/// A model that cannot be used is told of, and the one before goes on.
void look_for_model(serve::Service& service) {
  try {
    if (service.model().look()) fmt::print("model {}\n", service.model().now()->bundle().digest());
  } catch (const Error& error) {
    fmt::print(stderr, "warning: {}\n", error.what());
  }
  std::fflush(stdout);
}

/// Until the program is told to stop.
void attend(serve::Service& service, const std::stop_token& stop) {
  constexpr int looks_between_cleanings = 3600;
  constexpr double answers_are_kept_s = 30 * 86400.0;
  for (int i = 0; !stop.stop_requested(); ++i) {
    look_for_model(service);
    if (i % looks_between_cleanings == looks_between_cleanings - 1)
      service.repository().forget_calls(service.repository().now() - answers_are_kept_s);
    for (int k = 0; k < 10 && !stop.stop_requested(); ++k)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

int serve_until_stopped(const ServeOptions& options) {
  constexpr double grace_s = 30;
  const auto stop = base::interrupt_token();
  std::signal(SIGPIPE, SIG_IGN);  // whoever read our lines may be gone, and the server goes on
  serve::Service service(service_options(options));
  look_for_model(service);
  http::Server server({.address = options.address,
                       .port = static_cast<unsigned short>(options.port),
                       .threads = std::max(8, 2 * base::available_threads()),
                       .limits = options.limits,
                       .certificate = options.certificate,
                       .key = options.key},
                      service);
  fmt::print("listening at {}://{}:{}\n", options.certificate.empty() ? "http" : "https", options.address,
             server.port());
  std::fflush(stdout);
  attend(service, stop);
  server.stop(grace_s);
  return 0;
}

int run(int argc, char** argv) {
  ServeOptions options;
  cli::App app(
      "ELROM: what the models of a boiler exchange, and fields of its furnace on request, by REST.\n"
      "GET /openapi.json describes every request.",
      "elrom-serve");
  app.set_version_flag("--version", program_version());
  auto* data =
      app.add_option("--data", options.data, "Folder of the repository, made when missing")->type_name("DIR");
  app.add_option("--database", options.database, "sqlite (in DIR), or postgresql://user@host/name")
      ->capture_default_str();
  app.add_option("--address", options.address, "Address to listen at")->capture_default_str();
  app.add_option("--port", options.port, "Port to listen at; 0: any free one")
      ->check(cli::Range(0, 65535))
      ->capture_default_str();
  app.add_option("--model", options.model,
                 "Bundle, or study whose current model answers [default: DIR/study]")
      ->type_name("PATH");
  app.add_option("--page", options.page, "Folder of a page's files [default: ours, where it was built]")
      ->type_name("DIR");
  app.add_option("--openfoam-case", options.openfoam_case, "OpenFOAM case that downloads of starts are for")
      ->type_name("DIR");
  app.add_option("--certificate", options.certificate, "TLS certificate, PEM; with --key")->type_name("FILE");
  app.add_option("--key", options.key, "Its key, PEM")->type_name("FILE");
  app.add_option("--make-token", options.new_token,
                 "Make a token, print its secret and end; roles: reader, model, admin")
      ->type_name("NAME=ROLE");
  app.add_option("--anonymous", options.anonymous, "Role of who brings no token [default: none]")
      ->type_name("ROLE");
  app.add_option("--requests-per-second", options.limits.requests_per_second,
                 "Of one address, in the long run")
      ->check(cli::PositiveNumber)
      ->capture_default_str();
  app.add_flag("--quiet", options.quiet, "No line for each request on standard error");
  app.add_option("--backup", options.backup,
                 "Copy the repository to a new folder and end; a server may be writing")
      ->type_name("FOLDER");
  app.add_option("--restore", options.restored, "Fill an empty repository from such a folder and end")
      ->type_name("FOLDER");
  app.add_option("--judge-fields", options.judged,
                 "Look at a file of fields and end: 0 sound, 3 not; with --model, on its mesh and by physics")
      ->type_name("FILE");
  if (const auto status = app.parse(argc, argv)) return *status;
  if (!options.judged.empty()) return judge(options);
  if (data->count() == 0) throw UsageError(Problem{.what = "--data is missing", .expected = "--data DIR"});
  if (!options.backup.empty())
    return print(repository::back_up(repository_options(options), options.backup), "backed up");
  if (!options.restored.empty())
    return print(repository::restore(options.restored, repository_options(options)), "restored");
  options.limits.burst = std::max(options.limits.burst, 2 * options.limits.requests_per_second);
  return options.new_token.empty() ? serve_until_stopped(options) : make_token(options);
}

}  // namespace
}  // namespace elrom::programs

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-serve", [&] { return elrom::programs::run(argc, argv); });
}
