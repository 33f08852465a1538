#include "elrom/report/study_files.hpp"

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/study/settings.hpp"
#include "elrom/study/split.hpp"

namespace elrom::report {
namespace {

namespace fs = std::filesystem;
constexpr std::array usual_order{"nearest",         "linear",  "pod_rbf", "pod_gp",
                                 "pod_gp_per_mode", "pod_mlp", "networks"};

std::size_t rank_of(const std::string& method) {
  return static_cast<std::size_t>(std::find(usual_order.begin(), usual_order.end(), method) -
                                  usual_order.begin());
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

// Every number in timing.json under its path of keys joined by '/': the layout belongs to the trainer.
void flatten(const nlohmann::json& node, const std::string& prefix, std::map<std::string, double>& seconds) {
  if (node.is_number() && prefix != "format") seconds[prefix] = node.get<double>();
  if (!node.is_object()) return;
  for (const auto& [key, value] : node.items())
    flatten(value, prefix.empty() ? key : prefix + "/" + key, seconds);
}

std::map<std::string, double> stage_seconds(const fs::path& file) {
  std::map<std::string, double> seconds;
  if (!fs::exists(file)) return seconds;
  const auto root = nlohmann::json::parse(base::read_text(file), nullptr, false);
  if (root.is_discarded()) throw InputError({"not a JSON file", file.string()});
  flatten(root, "", seconds);
  return seconds;
}

// Seconds spent on everything whose name ends in one of a peer's spellings ("peer/pod_gp", "peers/pod_gp").
std::optional<double> peer_seconds(const std::map<std::string, double>& stages, const std::string& method) {
  std::optional<double> seconds;
  for (const auto& [stage, value] : stages)
    if (stage.ends_with("/" + method) || stage == method) seconds = seconds.value_or(0) + value;
  return seconds;
}

}  // namespace

bool is_simple_peer(const std::string& method) {
  constexpr std::array simple{"nearest", "linear", "pod_gp", "pod_gp_per_mode", "pod_rbf"};
  return std::find(simple.begin(), simple.end(), method) != simple.end();
}

StudyFiles open_study(const fs::path& directory, const std::optional<fs::path>& store) {
  const auto model = directory / "model.elrom", split_file = directory / "split.json";
  for (const auto& file : {model, split_file})
    if (!fs::exists(file))
      throw InputError({.what = "no trained study",
                        .where = directory.string(),
                        .found = "no " + file.filename().string(),
                        .advice = "run: elrom-train run " + directory.string()});
  const auto split = study::read_split(split_file);
  StudyFiles files{.directory = directory, .store = store ? *store : store_of(directory)};
  const auto stem = fs::weakly_canonical(directory).filename().string();
  files.name = stem.empty() ? directory.string() : stem;
  for (const auto* part : {&split.train, &split.validation, &split.test})
    files.building.insert(files.building.end(), part->begin(), part->end());
  files.held_out = split.held_out;
  files.stage_seconds = stage_seconds(directory / "timing.json");
  files.bundles.push_back({.name = "ELROM", .path = model});
  for (auto& peer : peers_of(directory)) files.bundles.push_back(std::move(peer));
  for (auto& bundle : files.bundles)
    if (bundle.name != "ELROM") bundle.train_seconds = peer_seconds(files.stage_seconds, bundle.name);
  if (const auto total = files.stage_seconds.find("total"); total != files.stage_seconds.end())
    files.bundles.front().train_seconds = total->second;
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
