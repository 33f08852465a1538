#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/shell.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/text.hpp"
#include "elrom/field/case_json.hpp"
#include "elrom/ingest/import_checked.hpp"
#include "elrom/masters/foreign_program.hpp"
#include "elrom/repository/rules.hpp"
#include "simulated_case.hpp"

namespace elrom::masters {
namespace {

using Json = nlohmann::ordered_json;
using serve::Claimed;
using serve::Finished;

constexpr int try_again = 75;  // EX_TEMPFAIL of sysexits.h

/// One run of the program in a folder of its own.
class ForeignRun {
 public:
  ForeignRun(const ForeignOptions& options, const Claimed& claimed, Log& log)
      : options_(options), claimed_(claimed), log_(log), folder_(made_folder()) {}

  Finished work(const std::stop_token& stop) {
    const base::Stopwatch watch;
    const auto values = template_values();
    fill_templates(options_.program.templates, copy(), values);
    run(stop);
    document_["seconds"] = watch.seconds();
    read_document();
    Finished finished{.version = options_.program.name};
    if (options_.program.cfd_case) finished.fields = fields_of_case(values, stop);
    finished.document = document_.dump();
    std::filesystem::remove_all(folder_);
    return finished;
  }

 private:
  [[nodiscard]] std::filesystem::path made_folder() const {
    auto folder = options_.folder / ("run_" + std::to_string(claimed_.run));
    std::filesystem::remove_all(folder);  // what an earlier try left
    std::filesystem::create_directories(folder);
    return folder;
  }
  [[nodiscard]] std::string name() const { return case_name(options_.model, claimed_.inputs_digest); }
  /// Named as the case: a reader of OpenFOAM's takes the case's name from it.
  [[nodiscard]] std::filesystem::path copy() const { return folder_ / name(); }

  [[nodiscard]] TemplateValues template_values() const {
    const auto inputs = Json::parse(claimed_.inputs);
    const auto one = Json{{"case", name()}, {"inputs", inputs}}.dump();
    const auto where = "run " + std::to_string(claimed_.run);
    const auto judged = repository::judge_inputs(one, where, nullptr, nullptr);
    return {.case_name = name(),
            .load = claimed_.load,
            .schema = field::declared_schema(one, where),
            .inputs = judged.inputs.values,
            .document = judged.document};
  }

  void run(const std::stop_token& stop) const {
    const auto said = folder_ / "log.txt";
    const auto end =
        base::run_shell(options_.program.command,
                        {.folder = copy(), .output = said, .seconds = options_.program.time_limit_s}, stop);
    if (end.well()) return;
    if (end.stopped) throw Interrupted(options_.program.name + " was stopped");
    const Problem problem{.what = options_.program.name + " " + end.in_words(),
                          .where = said.string(),
                          .found = last_line(said)};
    if (end.status == try_again) throw SystemError(problem);
    throw NumericalError(problem);
  }
  static std::string last_line(const std::filesystem::path& said) {
    return base::split(base::trim(base::read_text(said)), '\n').back();
  }

  void read_document() {
    if (!options_.program.document) return;
    const auto file = copy() / *options_.program.document;
    try {
      document_.update(Json::parse(base::read_text(file)));
    } catch (const Json::exception& error) {
      throw serve::WrongResultError(Problem{
          .what = "the program's document is no JSON object", .where = file.string(), .found = error.what()});
    }
  }

  /// Through import's door onto the reduced mesh.
  std::string fields_of_case(const TemplateValues& values, const std::stop_token& stop) {
    const auto store = folder_ / "snapshots.h5", table = folder_ / "cases.csv", file = folder_ / "fields.hdf";
    base::write_text(table, table_of(values));
    const auto left = copy() / fill_blanks(*options_.program.cfd_case, values, options_.program.name);
    try {
      expect_name(import({.mesh = options_.door.mesh,
                          .store = store,
                          .furnace = options_.door.furnace,
                          .files = {(left / "").parent_path().lexically_normal()},
                          .cases = table,
                          .n_threads = base::available_threads()},
                         stop));
    } catch (const InputError& refused) {
      throw serve::WrongResultError(refused.problem());
    }
    const auto opened = field::SnapshotStore::open(store);
    document_["averaging_window_s"] = opened.cases().front().averaging_window_s;
    write_simulation(opened, options_.program.name, file);
    return base::read_text(file);
  }
  /// A CFD case carries no boundary conditions: they are what was asked for.
  static std::string table_of(const TemplateValues& values) {
    std::string headings = "case", row = values.case_name;
    if (values.load) headings += ",load", row += "," + base::number(*values.load);
    for (std::size_t i = 0; i < values.schema.size(); ++i) {
      headings += "," + values.schema[i].name + " [" + values.schema[i].unit + "]";
      row += "," + base::number(values.inputs[i]);
    }
    return headings + "\n" + row + "\n";
  }
  [[nodiscard]] std::vector<std::string> import(const ingest::ImportOptions& door,
                                                const std::stop_token& stop) const {
    const ingest::Judgement judgement(ingest::Policy::refuse, ingest::accepted_kinds(options_.door.accepted));
    return ingest::import_checked(door, judgement, log_, stop).added;
  }
  void expect_name(const std::vector<std::string>& added) const {
    if (added != std::vector<std::string>{name()})
      throw InputError(Problem{.what = "the program left another case",
                               .where = options_.program.name,
                               .found = "'" + added.front() + "'",
                               .expected = "'" + name() + "'"});
  }

  const ForeignOptions& options_;
  const Claimed& claimed_;
  Log& log_;
  std::filesystem::path folder_;
  Json document_ = Json::object();
};

}  // namespace

serve::Master::Work foreign_work(const ForeignOptions& options, Log& log) {
  return [options, &log](const Claimed& claimed, const std::stop_token& stop) {
    expect_installed(options.program);
    return ForeignRun(options, claimed, log).work(stop);
  };
}

}  // namespace elrom::masters
