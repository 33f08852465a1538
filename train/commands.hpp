#pragma once
// The subcommands of elrom-train, one file each (command_<name>.cpp).

#include <CLI/CLI.hpp>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/study/study.hpp"

namespace elrom::train {

/// What every subcommand that works in a study takes.
struct StudyArguments {
  std::filesystem::path folder, store;
  std::string effort, device;
  int threads = -1;
  std::vector<std::string> settings;  ///< "key=value"
  bool quiet = false;

  void add_to(CLI::App& command);
  /// study.toml with the command line on top.
  [[nodiscard]] study::Settings resolve() const;
  [[nodiscard]] std::unique_ptr<Log> log() const;
};

/// What this build can train with (see make_trainer.cpp).
[[nodiscard]] study::Toolbox make_toolbox(const study::Settings& settings);

/// A subcommand sets `run` when it is chosen; its value is the exit status.
using Run = std::function<int()>;
void add_run(CLI::App& app, Run& run);
void add_screen(CLI::App& app, Run& run);
void add_search(CLI::App& app, Run& run);
void add_fit(CLI::App& app, Run& run);
void add_retrain(CLI::App& app, Run& run);
void add_status(CLI::App& app, Run& run);

}  // namespace elrom::train
