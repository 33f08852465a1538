#include "elrom/masters/build_work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/ingest/import_checked.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/study/retrain.hpp"
#include "simulated_case.hpp"

namespace elrom::masters {
namespace {

using Json = nlohmann::ordered_json;
using serve::Claimed;
using serve::Finished;

class Build {
 public:
  Build(const BuildOptions& options, Log& log, const std::stop_token& stop)
      : options_(options), log_(log), stop_(stop), settings_(study::study_settings(options.study)) {}

  Finished work(const Claimed& claimed) {
    for (const auto& source : claimed.sources)
      if (!source.fields.empty()) take_in(source, case_name(source.model, claimed.inputs_digest));
    const auto n_new = count_new();
    if (n_new < options_.enough)
      return told(fmt::format("{} of {} new cases; not trained", n_new, options_.enough), {});
    const auto report = study::retrain(options_.study, settings_, options_.toolbox, log_, stop_);
    return told(in_words(report), Json::parse(study::to_json(report)));
  }

 private:
  void take_in(const serve::SourceResult& source, const std::string& name) {
    const auto store = options_.study / settings_.store;                // which an absolute path replaces
    if (!field::SnapshotStore::open(store).find(name).empty()) return;  // by an earlier try
    const auto file = options_.folder / (name + ".hdf");
    base::write_text(file, source.fields);
    const ingest::ImportOptions door{.store = store, .files = {file}, .n_threads = settings_.n_threads()};
    try {
      expect_name(file, name);
      import(door);
    } catch (const InputError& refused) {
      std::filesystem::remove(file);
      throw serve::WrongResultError(refused.problem());
    }
    std::filesystem::remove(file);
    log_.info(name + " taken into " + store.string());
  }

  static void expect_name(const std::filesystem::path& file, const std::string& name) {
    const auto found = ingest::read_simulation(file).record.inputs.name;
    if (found == name) return;
    throw InputError(
        Problem{.what = "fields of another case", .found = "'" + found + "'", .expected = "'" + name + "'"});
  }
  void import(const ingest::ImportOptions& door) const {
    const ingest::Judgement judgement(ingest::Policy::refuse, ingest::accepted_kinds(options_.accepted));
    (void)ingest::import_checked(door, judgement, log_, stop_);
  }

  /// Cases that a training would learn from and the model did not.
  [[nodiscard]] std::size_t count_new() const {
    const auto known = model::BundleReader(options_.study / "model.elrom").info().cases;
    const study::Study study(options_.study, settings_, options_.toolbox, log_, stop_);
    return static_cast<std::size_t>(std::ranges::count_if(study.cases().names, [&](const std::string& name) {
      return std::ranges::find(known, name) == known.end();
    }));
  }

  static std::string in_words(const study::RetrainReport& report) {
    const auto number = report.promotion.number;
    if (report.nothing_new) return fmt::format("nothing new: version {} answers", number);
    const auto cases = fmt::format("{} -> {} cases", report.cases_before, report.cases_after);
    return report.promoted() ? fmt::format("{}: version {} answers", cases, number)
                             : fmt::format("{}: version {} is worse and does not answer", cases, number);
  }

  [[nodiscard]] Finished told(const std::string& reason, const Json& report) const {
    return {.version = model::BundleReader(options_.study / "model.elrom").digest(),
            .reason = reason,
            .document = Json{{"told", reason}, {"training", report.empty() ? Json() : report}}.dump()};
  }

  const BuildOptions& options_;
  Log& log_;
  std::stop_token stop_;
  study::Settings settings_;
};

}  // namespace

serve::Master::Work build_work(const BuildOptions& options, Log& log) {
  return [options, &log](const Claimed& claimed, const std::stop_token& stop) {
    return Build(options, log, stop).work(claimed);
  };
}

}  // namespace elrom::masters
