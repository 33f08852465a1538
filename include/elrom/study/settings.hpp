#pragma once
// Settings of a study: study.toml and the command line, resolved over the defaults of an effort level.
// Every setting and its meaning stand in one table (train/study/settings_table.cpp); keys that are not in it
// are refused with the nearest known one.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "elrom/methods/catalogue.hpp"
#include "elrom/networks/settings.hpp"

namespace elrom::study {

/// What a study without networks, or a peer beside them, is fitted with.
struct PeerSettings {
  std::vector<std::string> methods = elrom::methods::peer_names();  ///< bundles beside the model
  bool networks = true;  ///< networks take part in "auto" and get a bundle of their own
  int folds = 8;         ///< load-grouped folds of the cross-validation in "auto"
};

struct TrainSettings {
  std::vector<std::string> exclude;  ///< cases neither trained on nor held out: names or patterns
};

/// When a new model may take the place of the present one (gate.hpp).
struct GateSettings {
  double tolerance = 0.01;  ///< NRMSE that a field may lose
  double deviations = 3;    ///< standard deviations of the scatter from which on a difference is real
};

struct Settings : networks::Settings {
  std::string effort = "standard";  ///< "quick" | "standard" | "thorough"
  std::string method = "auto";
  std::string store = "snapshots.h5";
  std::int64_t seed = 1;
  int threads = 0;  ///< 0: all
  std::string device = "cpu";
  std::vector<std::string> fields;  ///< empty: all of the store
  std::string date;                 ///< kept in the bundle as it stands; empty: none
  TrainSettings train;
  GateSettings gate;
  PeerSettings peers;

  [[nodiscard]] int n_threads() const;  ///< threads, or what the machine has
};

/// @param file study.toml; need not exist @param overrides "key=value" from the command line, which win over
/// the file
/// @throws UsageError for an unknown key or a value of another type or out of range, with file:line and the
/// nearest key
[[nodiscard]] Settings read_settings(const std::filesystem::path& file,
                                     const std::vector<std::string>& overrides = {});

/// The same from a study's folder. The store that an earlier run was given stands in resolved.toml, and is
/// taken from there where neither study.toml nor the command line names one.
[[nodiscard]] Settings study_settings(const std::filesystem::path& study,
                                      const std::vector<std::string>& overrides = {});

/// The whole settings as TOML that reads back to the same
/// settings; `section` ("screen") limits it to one table.
[[nodiscard]] std::string to_toml(const Settings& settings, std::string_view section = {});

/// Key, default and meaning of every setting, for --help.
struct SettingHelp {
  std::string key, value, meaning;
};
[[nodiscard]] std::vector<SettingHelp> settings_help();

}  // namespace elrom::study
