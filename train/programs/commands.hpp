#pragma once
// The subcommands of elrom-train, one file each (command_<name>.cpp).

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "elrom/base/log.hpp"
#include "elrom/cli/cli.hpp"
#include "elrom/study/study.hpp"
#include "elrom/surrogate/tree_trainer.hpp"

namespace elrom::programs {

/// What every subcommand that works in a study takes.
struct StudyArguments {
  std::filesystem::path folder, store;
  std::string effort, device, date;
  int threads = -1;
  std::vector<std::string> settings;  ///< "key=value"
  bool quiet = false;

  void add_to(cli::App& command);
  /// study.toml with the command line on top.
  [[nodiscard]] study::Settings resolve() const;
  [[nodiscard]] std::unique_ptr<Log> log() const;
};

/// What a subcommand does with the study that its arguments name; its value is the exit status.
using StudyWork = std::function<int(const study::Settings& settings, const study::Toolbox& tools, Log& log)>;
/// Does it with what this build can train with (study_tools.cpp). Among several processes (mpirun) one does;
/// the others train for it. @throws NotBuiltError for several processes without MPI
[[nodiscard]] int in_study(const StudyArguments& arguments, const StudyWork& work);

/// What this build can train with; missing parts say so when they are asked to train.
/// @throws NotBuiltError for a device other than the processor without LibTorch
[[nodiscard]] std::shared_ptr<const networks::Trainer> make_network_trainer(const std::string& device);
[[nodiscard]] std::shared_ptr<const surrogate::TreeTrainer> make_tree_trainer();

/// Says what became of the model. @return the exit status that tells it to scripts
[[nodiscard]] int tell(const study::Promotion& promotion, const std::filesystem::path& folder);

/// A subcommand sets `run` when it is chosen; its value is the exit status.
using Work = std::function<int()>;
void add_run(cli::App& app, Work& run);
void add_screen(cli::App& app, Work& run);
void add_search(cli::App& app, Work& run);
void add_fit(cli::App& app, Work& run);
void add_retrain(cli::App& app, Work& run);
void add_status(cli::App& app, Work& run);
void add_versions(cli::App& app, Work& run);  ///< log, diff, promote, rollback
void add_collisions(cli::App& app, Work& run);

}  // namespace elrom::programs
