// elrom-report: how good a study's model is, which of two is better, what more cases would buy,
// and what accuracy costs; how good collision models are; runs of a scene beside each other.

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/comma_list.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/version.hpp"
#include "elrom/cli/cli.hpp"
#include "elrom/report/accuracy.hpp"
#include "elrom/report/collisions.hpp"
#include "elrom/report/compare.hpp"
#include "elrom/report/cost.hpp"
#include "elrom/report/learning_curve.hpp"
#include "elrom/report/page.hpp"
#include "elrom/report/scenes.hpp"

namespace {

using namespace elrom;
namespace fs = std::filesystem;

struct Arguments {
  std::vector<std::string> studies, against, fields, models, cases, runs;
  std::string store, json, csv, html, method, collisions, a, b;
  report::Reference reference;
  int threads = 0, points = 5, repeats = 3;
  std::uint64_t seed = 1;
  std::size_t calls = 1'000'000;
  std::optional<double> from;
  std::vector<double> wanted;
  double start_up_hours = 0;
  bool small = false, v1_v2 = false, quiet = false, no_peers = false, full = false;

  [[nodiscard]] int n_threads() const { return threads > 0 ? threads : base::available_threads(); }
  [[nodiscard]] std::optional<fs::path> store_path() const {
    return store.empty() ? std::nullopt : std::optional<fs::path>(store);
  }
};

void write(const fs::path& path, const std::string& text, Log& log) {
  base::write_text(path, text);
  log.info("wrote " + path.string());
}

bool wants_colour() { return ::isatty(STDOUT_FILENO) != 0 && std::getenv("NO_COLOR") == nullptr; }

int run_accuracy(const Arguments& arguments, Log& log) {
  const auto study = fs::path(arguments.studies.front());
  report::AccuracyOptions options{.study = study,
                                  .store = arguments.store_path(),
                                  .cases = arguments.cases,
                                  .n_threads = arguments.n_threads()};
  options.against.assign(arguments.against.begin(), arguments.against.end());
  options.figures = !arguments.html.empty();
  const auto accuracy = report::evaluate(options, log, base::interrupt_token());
  fmt::print("{}", report::terminal_table(accuracy, wants_colour()));
  if (!arguments.json.empty()) write(arguments.json, report::to_json(accuracy), log);
  if (!arguments.csv.empty()) write(arguments.csv, report::to_csv(accuracy), log);
  if (!arguments.html.empty()) {
    auto extras = report::find_extras(accuracy.study);
    if (!extras.cost) {
      extras.cost.emplace().reference = arguments.reference;
      report::add_points(*extras.cost, accuracy, true);
    }
    write(arguments.html, report::html_page(accuracy, extras), log);
  }
  return 0;
}

int run_compare(const Arguments& arguments, Log& log) {
  const report::CompareOptions options{.a = arguments.a,
                                       .b = arguments.b,
                                       .cases = arguments.cases,
                                       .store = arguments.store_path(),
                                       .n_threads = arguments.n_threads(),
                                       .figures = !arguments.html.empty()};
  const auto comparison = report::compare(options, log, base::interrupt_token());
  fmt::print("{}", report::terminal_table(comparison));
  if (!arguments.json.empty()) write(arguments.json, report::to_json(comparison), log);
  if (!arguments.html.empty()) write(arguments.html, report::html_page(comparison), log);
  return static_cast<int>(comparison.b_is_worse() ? ExitStatus::refused : ExitStatus::ok);
}

int run_learning_curve(const Arguments& arguments, Log& log) {
  const auto study = fs::path(arguments.studies.front());
  report::LearningCurveOptions options{.study = study,
                                       .store = arguments.store_path(),
                                       .cases = arguments.cases,
                                       .method = arguments.method,
                                       .fields = arguments.fields,
                                       .n_points = arguments.points,
                                       .n_repeats = arguments.repeats,
                                       .seed = arguments.seed,
                                       .n_threads = arguments.n_threads()};
  if (arguments.small) {
    options.n_points = 3;
    options.n_repeats = 1;
  }
  if (arguments.start_up_hours > arguments.reference.hours)
    throw UsageError("--start-up-hours is part of --case-hours, and more than it");
  auto curve = report::learning_curve(options, log, base::interrupt_token());
  curve.small = arguments.small;
  curve.price = {arguments.reference.name, arguments.reference.hours, arguments.start_up_hours};
  fmt::print("{}", arguments.v1_v2
                       ? report::v1_v2_table(curve)
                       : report::terminal_table(curve) + report::purchase_table(curve, arguments.wanted));
  const auto usual = arguments.small ? "learning-curve-small.json" : "learning-curve.json";
  write(arguments.json.empty() ? study / usual : fs::path(arguments.json), report::to_json(curve), log);
  return 0;
}

int run_cost(const Arguments& arguments, Log& log) {
  report::CostOptions options{.store = arguments.store_path(),
                              .cases = arguments.cases,
                              .peers = !arguments.no_peers,
                              .sizes = arguments.full,
                              .n_threads = arguments.n_threads(),
                              .reference = arguments.reference};
  options.studies.assign(arguments.studies.begin(), arguments.studies.end());
  const auto cost = report::cost_report(options, log, base::interrupt_token());
  fmt::print("{}", report::terminal_table(cost));
  write(arguments.json.empty() ? options.studies.front() / "cost.json" : fs::path(arguments.json),
        report::to_json(cost), log);
  return 0;
}

int run_collisions(const Arguments& arguments, Log& log) {
  report::CollisionReportOptions options{.set = arguments.collisions, .n_calls = arguments.calls};
  options.models.assign(arguments.models.begin(), arguments.models.end());
  const auto report = report::collision_report(options, log, base::interrupt_token());
  fmt::print("{}", report::terminal_table(report));
  if (!arguments.json.empty()) write(arguments.json, report::to_json(report), log);
  if (!arguments.html.empty()) write(arguments.html, report::html_page(report), log);
  return 0;
}

int run_scenes(const Arguments& arguments, Log& log) {
  report::SceneReportOptions options{.from = arguments.from};
  options.folders.assign(arguments.runs.begin(), arguments.runs.end());
  const auto report = report::scene_report(options);
  fmt::print("{}", report::terminal_table(report));
  if (!arguments.json.empty()) write(arguments.json, report::to_json(report), log);
  if (!arguments.html.empty()) write(arguments.html, report::html_page(report), log);
  return 0;
}

void add_common(cli::App& command, Arguments& arguments) {
  command.add_option("--store", arguments.store, "store of cases, instead of the one the study names");
  base::comma_list(command.add_option("--cases", arguments.cases,
                                      "cases to judge on, names or patterns, separated by commas; default: "
                                      "those that the study (of compare: A's) held out"));
  command.add_option("--threads", arguments.threads, "threads to use; 0: all")
      ->capture_default_str()
      ->check(cli::NonNegativeNumber);
  command.add_flag("--quiet", arguments.quiet, "no progress, only results and warnings");
}

void add_case_hours(cli::App& command, Arguments& arguments) {
  auto& reference = arguments.reference;
  command.add_option("--case-name", reference.name, "what computed the cases")->capture_default_str();
  command
      .add_option("--case-hours", reference.hours,
                  "what it takes for one case, to show beside the models [h]")
      ->check(cli::NonNegativeNumber);
}

void add_reference(cli::App& command, Arguments& arguments) {
  add_case_hours(command, arguments);
  command.add_option("--case-cores", arguments.reference.cores, "cores that it takes")
      ->capture_default_str()
      ->check(cli::PositiveNumber);
}

void add_accuracy(cli::App& app, Arguments& arguments) {
  auto& command = *app.add_subcommand(
      "accuracy", "Errors on the held-out cases, beside every peer; table, JSON, CSV and one HTML page");
  command.add_option("study", arguments.studies, "a trained study directory")->required()->expected(1);
  command.add_option("--json", arguments.json, "write all figures as JSON");
  command.add_option("--csv", arguments.csv, "write errors by field, method and case as CSV");
  command.add_option("--html", arguments.html, "write the page: one file that opens offline");
  base::comma_list(command.add_option(
      "--against", arguments.against,
      "further bundles (.elrom) or studies to show beside the peers, separated by commas; repeatable"));
  command.add_flag("--small", arguments.small,
                   "accepted for scripts: this command ends within a minute anyway");
  add_reference(command, arguments);
  add_common(command, arguments);
}

void add_compare(cli::App& app, Arguments& arguments) {
  auto& command = *app.add_subcommand(
      "compare", "Is B better than A? Field by field on the same cases; exit status 7 where B is worse");
  command.add_option("A", arguments.a, "a bundle (.elrom) or a trained study")->required();
  command.add_option("B", arguments.b, "another")->required();
  command.add_option("--json", arguments.json, "write all figures as JSON");
  command.add_option("--html", arguments.html, "write the page with cuts: one file that opens offline");
  add_common(command, arguments);
}

void add_learning_curve(cli::App& app, Arguments& arguments) {
  auto& command = *app.add_subcommand(
      "learning-curve", "What more cases buy: the method fitted anew on subsets of its training cases");
  command.add_option("study", arguments.studies, "a trained study directory")->required()->expected(1);
  command.add_option(
      "--json", arguments.json,
      "where to write; default STUDY/learning-curve.json, which the page then shows; with --small "
      "STUDY/learning-curve-small.json, which it shows where there is no other");
  command.add_option("--method", arguments.method,
                     "method to fit; default: the one that answers for most fields of the study");
  base::comma_list(command.add_option("--fields", arguments.fields,
                                      "fields, separated by commas; default: all of the study"));
  command.add_option("--points", arguments.points, "subset sizes from an eighth of the cases to all")
      ->capture_default_str()
      ->check(cli::Range(2, 50));
  command.add_option("--repeats", arguments.repeats, "random nested draws")
      ->capture_default_str()
      ->check(cli::Range(1, 100));
  command.add_option("--seed", arguments.seed, "seed of the draws")->capture_default_str();
  command.add_flag("--v1-v2", arguments.v1_v2,
                   "print the source's comparison: a third of the cases against all, by field");
  base::comma_list(command.add_option(
      "--wanted", arguments.wanted,
      "errors to be reached, separated by commas; default: 10, 20, 30 and 50 % below that of all cases"));
  command.add_flag("--small", arguments.small, "three sizes, one draw: ends within a minute");
  add_case_hours(command, arguments);
  command
      .add_option("--start-up-hours", arguments.start_up_hours,
                  "of these, hours before averaging begins; default: 0")
      ->check(cli::NonNegativeNumber);
  add_common(command, arguments);
}

void add_cost(cli::App& app, Arguments& arguments) {
  auto& command = *app.add_subcommand(
      "cost", "Error against training and prediction time, for the studies named and their peers");
  command
      .add_option("studies", arguments.studies, "trained study directories; changes are against the first")
      ->required();
  command.add_option("--json", arguments.json,
                     "where to write; default FIRST_STUDY/cost.json, which the page then shows");
  command.add_flag("--full", arguments.full,
                   "also fits to fewer of the first study's cases, every method that needs no search, three "
                   "draws each: some minutes");
  command.add_flag("--no-peers", arguments.no_peers, "the studies' own models only (an ablation table)");
  command.add_flag("--small", arguments.small,
                   "accepted for scripts: this command ends within a minute anyway");
  add_reference(command, arguments);
  add_common(command, arguments);
}

void add_collisions(cli::App& app, Arguments& arguments) {
  auto& command = *app.add_subcommand(
      "collisions", "Collision models beside each other: errors, momentum and energy, what accuracy costs");
  command.add_option("set", arguments.collisions, "a set made by elrom-data collisions; its last 5 % judge")
      ->required();
  command.add_option("models", arguments.models, "collision models (.elrom) made by elrom-train collisions")
      ->required();
  command.add_option("--json", arguments.json, "write all figures as JSON");
  command.add_option("--html", arguments.html, "write the page: one file that opens offline");
  command.add_option("--calls", arguments.calls, "calls of each model that its speed is measured by")
      ->capture_default_str()
      ->check(cli::PositiveNumber);
  command.add_flag("--small", arguments.small,
                   "accepted for scripts: this command ends within a minute anyway");
  command.add_flag("--quiet", arguments.quiet, "no progress, only results and warnings");
}

void add_scenes(cli::App& app, Arguments& arguments) {
  auto& command = *app.add_subcommand(
      "scenes",
      "Runs of one scene by several collision models and time steps beside each other, DEM as the yardstick");
  command.add_option("runs", arguments.runs, "folders that elrom-simulate wrote (--output)")->required();
  command.add_option("--json", arguments.json, "write all figures as JSON");
  command.add_option("--html", arguments.html, "write the page: one file that opens offline");
  command
      .add_option("--from", arguments.from,
                  "sections are averaged from this time on [s]; default: half of the first run")
      ->check(cli::NonNegativeNumber);
  command.add_flag("--small", arguments.small,
                   "accepted for scripts: this command ends within a minute anyway");
  command.add_flag("--quiet", arguments.quiet, "no progress, only results and warnings");
}

int run(int argc, char** argv) {
  base::keep_freed_memory();
  cli::App app(R"(Reports on trained ELROM studies, collision models and simulated scenes.
Exit status: 2 usage, 3 input, 5 numerical, 7 B is worse than A (compare), 130 interrupted.)",
               "elrom-report");
  app.set_version_flag("--version", program_version());
  app.require_subcommand(1);
  Arguments arguments;
  add_accuracy(app, arguments);
  add_compare(app, arguments);
  add_learning_curve(app, arguments);
  add_cost(app, arguments);
  add_collisions(app, arguments);
  add_scenes(app, arguments);
  if (const auto status = app.parse(argc, argv)) return *status;
  const auto log = make_console_log(arguments.quiet ? Level::warning : Level::info);
  for (const auto& file : {arguments.json, arguments.csv, arguments.html})
    if (!file.empty()) base::expect_writable(file);
  if (app.got_subcommand("accuracy")) return run_accuracy(arguments, *log);
  if (app.got_subcommand("compare")) return run_compare(arguments, *log);
  if (app.got_subcommand("learning-curve")) return run_learning_curve(arguments, *log);
  if (app.got_subcommand("collisions")) return run_collisions(arguments, *log);
  if (app.got_subcommand("scenes")) return run_scenes(arguments, *log);
  return run_cost(arguments, *log);
}

}  // namespace

int main(int argc, char** argv) {
  return elrom::base::run_app("elrom-report", [&] { return run(argc, argv); });
}
