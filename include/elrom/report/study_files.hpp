#pragma once
// What a trained study directory holds for a report: its store,
// its split, its bundles and what they took to train.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace elrom::report {

/// A bundle to judge.
struct BundleFile {
  std::string name;  ///< "ELROM", or the peer's method: "pod_gp"
  std::filesystem::path path;
  bool is_peer = false;                 ///< one of the simple methods that ELROM is measured against
  std::optional<double> train_seconds;  ///< measured when it was trained
};

struct StudyFiles {
  std::filesystem::path directory, store, settings;
  std::string name;                             ///< of the directory
  std::vector<std::string> building;            ///< cases that may be learnt from, in split.json's order
  std::vector<std::string> held_out;            ///< all of them
  std::vector<BundleFile> bundles;              ///< the study's model first, then peers in their usual order
  std::map<std::string, double> stage_seconds;  ///< timing.json, by stage
};

/// @param store instead of the one the settings name
/// @param cases names or patterns of cases to judge on, instead of those that the study held out; empty: none
/// @throws InputError when it is no trained study (what is missing, and the command that makes it);
///         UsageError for cases that the store does not hold, or that the study was trained on
[[nodiscard]] StudyFiles open_study(const std::filesystem::path& directory,
                                    const std::optional<std::filesystem::path>& store = {},
                                    const std::vector<std::string>& cases = {});

/// Bundles of `path`: a bundle file, or a study directory's model.
[[nodiscard]] BundleFile open_other(const std::filesystem::path& path);

/// The methods that count as simple peers: nearest, linear, POD
/// with a Gaussian process or radial basis functions.
[[nodiscard]] bool is_simple_peer(const std::string& method);

}  // namespace elrom::report
