#include "elrom/report/study_files.hpp"

#include <algorithm>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/methods/catalogue.hpp"
#include "elrom/study/held_out.hpp"
#include "elrom/study/settings.hpp"
#include "elrom/study/timing.hpp"
#include "store_rows.hpp"

namespace elrom::report {
namespace {

namespace fs = std::filesystem;

// Bundles that are no method of ours come last.
int rank_of(const std::string& method) {
  const auto* known = methods::find_method(method);
  return known == nullptr ? std::numeric_limits<int>::max() : known->place;
}

fs::path settings_file(const fs::path& directory) {
  return fs::exists(directory / "resolved.toml") ? directory / "resolved.toml" : directory / "study.toml";
}

fs::path store_of(const fs::path& directory) {
  const fs::path store = study::read_settings(settings_file(directory)).store;
  if (store.is_absolute() || fs::exists(directory / store)) return directory / store;
  return fs::exists(store) ? store : directory / store;
}

std::vector<BundleFile> peers_of(const fs::path& directory) {
  std::vector<BundleFile> peers;
  if (!fs::is_directory(directory / "peers")) return peers;
  for (const auto& entry : fs::directory_iterator(directory / "peers")) {
    if (entry.path().extension() != ".elrom") continue;
    const auto method = entry.path().stem().string();
    peers.push_back({.name = method, .path = entry.path(), .is_peer = is_simple_peer(method)});
  }
  std::sort(peers.begin(), peers.end(), [](const BundleFile& a, const BundleFile& b) {
    return std::pair(rank_of(a.name), a.name) < std::pair(rank_of(b.name), b.name);
  });
  return peers;
}

// The last run that reused nothing tells what the study takes; later ones only what was left to do.
void read_timing(StudyFiles& study, const std::string& model_method) {
  const auto timing = study::read_timing(study.directory / "timing.json");
  if (!timing) return;
  study.stage_seconds = timing->full_seconds ? timing->full_stages : timing->stages;
  for (auto& bundle : study.bundles) {
    const auto found = timing->methods.find(&bundle == &study.bundles.front() ? model_method : bundle.name);
    if (found != timing->methods.end()) bundle.train_seconds = found->second;
  }
}

// Judging on what was learnt would flatter.
void judge_on(StudyFiles& study, const std::vector<std::string>& cases) {
  study.held_out = named_cases(field::SnapshotStore::open(study.store), cases);
  for (const auto& name : study.held_out)
    if (std::ranges::find(study.building, name) != study.building.end())
      throw UsageError({.what = "the study was trained on case '" + name + "'",
                        .where = study.directory.string(),
                        .advice = "judge on cases that it has not seen"});
}

}  // namespace

bool is_simple_peer(const std::string& method) {
  const auto* known = methods::find_method(method);
  return known != nullptr && known->peer;
}

StudyFiles open_study(const fs::path& directory, const std::optional<fs::path>& store,
                      const std::vector<std::string>& cases) {
  const auto model = directory / "model.elrom", split_file = directory / "split.json";
  for (const auto& file : {model, split_file})
    if (!fs::exists(file))
      throw InputError({.what = "no trained study",
                        .where = directory.string(),
                        .found = "no " + file.filename().string(),
                        .advice = "run: elrom-train run " + directory.string()});
  const auto split = study::read_split(split_file);
  StudyFiles files{.directory = directory,
                   .store = store ? *store : store_of(directory),
                   .settings = settings_file(directory)};
  const auto stem = fs::weakly_canonical(directory).filename().string();
  files.name = stem.empty() ? directory.string() : stem;
  for (const auto* part : {&split.train, &split.validation, &split.test})
    files.building.insert(files.building.end(), part->begin(), part->end());
  files.held_out = split.held_out;
  if (!cases.empty()) judge_on(files, cases);
  files.bundles.push_back({.name = "ELROM", .path = model});
  for (auto& peer : peers_of(directory)) files.bundles.push_back(std::move(peer));
  read_timing(files, study::read_settings(settings_file(directory)).method);
  return files;
}

BundleFile open_other(const fs::path& path) {
  const bool is_study = fs::is_directory(path);
  const auto file = is_study ? path / "model.elrom" : path;
  if (!fs::exists(file))
    throw InputError({.what = "no bundle to compare with",
                      .where = path.string(),
                      .expected = "a .elrom file or a trained study"});
  const auto name = is_study ? fs::weakly_canonical(path).filename().string() : path.stem().string();
  return {.name = name, .path = file};
}

}  // namespace elrom::report
