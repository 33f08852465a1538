#include <fmt/format.h>

#include <map>

#include "commands.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/model/bundle.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/settings.hpp"
#include "elrom/study/timing.hpp"
#include "elrom/study/versions.hpp"

namespace elrom::programs {
namespace {

using std::filesystem::path;

void print_store(const path& folder) {
  if (!std::filesystem::exists(folder / "resolved.toml")) return;
  const auto store = folder / study::study_settings(folder).store;
  fmt::print("store      {}{}\n", store.lexically_normal().string(),
             std::filesystem::exists(store) ? "" : " (not there any more; --store names another)");
}

void print_split(const path& folder) {
  if (!std::filesystem::exists(folder / "split.json")) return;
  const auto split = study::read_split(folder / "split.json");
  fmt::print("cases      {} train, {} validation, {} test, {} held out, {} excluded (by {})\n",
             split.train.size(), split.validation.size(), split.test.size(), split.held_out.size(),
             split.excluded.size(), split.by);
}

void print_stages(const path& folder) {
  std::map<std::string, int> count;
  if (std::filesystem::is_directory(folder / "stages")) {
    for (const auto& entry : std::filesystem::directory_iterator(folder / "stages")) {
      const auto name = entry.path().filename().string();
      if (entry.path().extension() == ".elrom") ++count[name.substr(0, name.find('-'))];
    }
  }
  for (const auto& [stage, n] : count) fmt::print("kept       {} results of stage {}\n", n, stage);
}

void print_trials(const path& folder) {
  if (!std::filesystem::exists(folder / "search.sqlite")) return;
  for (const auto& search : networks::TrialStore(folder / "search.sqlite").searches()) {
    double best = HUGE_VAL;
    int pruned = 0;
    for (const auto& trial : search.trials) {
      if (!trial.pruned && trial.i_seed == 0) best = std::min(best, trial.value);
      pruned += trial.pruned;
    }
    fmt::print("search     {}: {} trials, {} pruned, best {}\n", search.name, search.trials.size(), pruned,
               base::rounded(best));
  }
}

void print_bundle(const path& file) {
  const model::BundleReader bundle(file);
  fmt::print("bundle     {}: {}, {} fields, {} cases\n", file.string(), bundle.info().method,
             bundle.info().fields.size(), bundle.info().cases.size());
}

void print_bundles(const path& folder) {
  if (std::filesystem::exists(folder / "model.elrom")) print_bundle(folder / "model.elrom");
  const study::Versions versions(folder);
  if (const auto current = versions.current())
    fmt::print("versions   {}, of which {} answers (elrom-train log)\n", versions.numbers().size(), *current);
  if (!std::filesystem::is_directory(folder / "peers")) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "peers")) {
    if (entry.path().extension() == ".elrom") print_bundle(entry.path());
  }
}

void print_timing(const path& folder) {
  if (const auto timing = study::read_timing(folder / "timing.json"))
    fmt::print("last run   {}, {} GiB resident at most\n", base::duration(timing->total_seconds),
               base::rounded(timing->peak_rss_gib, 3));
}

}  // namespace

void add_status(cli::App& app, Work& run) {
  auto* command =
      app.add_subcommand("status", "what a study holds: cases, kept stages, trials, bundles, time");
  auto folder = std::make_shared<path>();
  command->add_option("STUDY", *folder, "folder of the study")->required();
  command->callback([&run, folder] {
    run = [folder] {
      if (!std::filesystem::is_directory(*folder))
        throw InputError({.what = "no such folder", .where = folder->string()});
      print_store(*folder);
      print_split(*folder);
      print_stages(*folder);
      print_trials(*folder);
      print_bundles(*folder);
      print_timing(*folder);
      return 0;
    };
  });
}

}  // namespace elrom::programs
