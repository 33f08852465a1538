#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <thread>

#include "commands.hpp"
#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/shell.hpp"
#include "elrom/base/text.hpp"
#include "elrom/ingest/watch.hpp"
#include "judgement_options.hpp"

namespace elrom::programs {
namespace {

struct WatchOptions {
  ingest::WatchOptions watch;
  JudgementOptions judgement;
  std::string command;
  std::optional<double> every;
  bool once = false;
};

/// Sleeps, but wakes when it is to end.
void wait(double seconds, const std::stop_token& stop) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!stop.stop_requested() && std::chrono::steady_clock::now() < end)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
}

/// Tells the command what was added. @return how it ended, in words; empty: well
std::string run_command(const std::string& command, const std::filesystem::path& store,
                        const std::vector<std::string>& added, const std::stop_token& stop) {
  std::fflush(stdout);
  return base::run_shell(command,
                         {.environment = {{"ELROM_STORE", std::filesystem::absolute(store).string()},
                                          {"ELROM_ADDED", base::join(added, ",")}}},
                         stop)
      .in_words();
}

/// Names of the store's cases while a batch and its command are under way: what a killed watch added, and
/// told nobody of, is found by the next one.
class Pending {
 public:
  explicit Pending(const WatchOptions& options)
      : store_(options.watch.import.store), file_(options.watch.folder / ".elrom-watch-pending") {}

  void begin() const {
    if (std::filesystem::exists(file_)) return;
    base::write_text(file_, base::join(cases(), "\n") + "\n");
  }
  void end() const { std::filesystem::remove(file_); }
  [[nodiscard]] std::vector<std::string> left_over() const {
    if (!std::filesystem::exists(file_)) return {};
    const auto before = base::split(base::read_text(file_), '\n');
    auto names = cases();
    std::erase_if(names, [&](const std::string& name) {
      return std::find(before.begin(), before.end(), name) != before.end();
    });
    return names;
  }

 private:
  [[nodiscard]] std::vector<std::string> cases() const {
    std::vector<std::string> names;
    if (!std::filesystem::exists(store_)) return names;
    const auto store = field::SnapshotStore::open(store_);
    for (const auto& one : store.cases()) names.push_back(one.inputs.name);
    return names;
  }

  std::filesystem::path store_, file_;
};

/// "README.txt, solver.log and 12 more"
std::string names_of(std::vector<std::filesystem::path> files) {
  constexpr std::size_t most = 5;
  std::ranges::sort(files);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < std::min(most, files.size()); ++i)
    names.push_back(files[i].filename().string());
  return base::join(names, ", ") +
         (files.size() > most ? " and " + std::to_string(files.size() - most) + " more" : "");
}

class Watch {
 public:
  explicit Watch(const WatchOptions& options)
      : options_(options), pending_(options), watcher_(watch_options()) {}

  int run() {
    if (!options_.command.empty()) after(pending_.left_over());
    if (!options_.once) fmt::print("watching {}; Ctrl-C ends it\n", options_.watch.folder.string());
    // Two looks tell what is finished.
    look();
    do {
      std::fflush(stdout);
      wait(options_.every.value_or(options_.once ? 1 : 10), stop_);
      if (!stop_.stop_requested()) look();
    } while (!options_.once && !stop_.stop_requested());
    if (stop_.stop_requested()) throw Interrupted("watching ended; the store holds what was imported");
    return status();
  }

 private:
  [[nodiscard]] ingest::WatchOptions watch_options() const {
    auto watch = options_.watch;
    watch.accepted = options_.judgement.read().accepted;
    if (!options_.command.empty()) watch.before_import = [this] { pending_.begin(); };
    return watch;
  }

  void look() {
    try {
      const auto found = watcher_.look(*log_, stop_);
      tell(found);
      after(found.added);
    } catch (const UsageError& busy) {
      if (options_.once) throw;
      log_->warning(std::string(busy.what()) + "; tried again at the next look");
    }
  }

  void tell(const ingest::Look& found) {
    n_added_ += found.added.size();
    n_refused_ += found.refused.size();
    n_unfinished_ = found.n_unfinished;
    if (!found.left_alone.empty()) fmt::print("left alone, no exports: {}\n", names_of(found.left_alone));
    for (const auto& refusal : found.refused)
      fmt::print("refused: {}: {}\n", refusal.file.filename().string(), refusal.reason);
    if (!found.added.empty())
      fmt::print("added: {}; {} now holds {}\n", base::join(found.added, ", "),
                 options_.watch.import.store.string(), found.n_cases);
  }

  void after(const std::vector<std::string>& added) {
    if (options_.command.empty()) return;
    if (!added.empty()) {
      const auto failure = run_command(options_.command, options_.watch.import.store, added, stop_);
      if (!failure.empty()) log_->warning("'" + options_.command + "' " + failure);
    }
    if (!stop_.stop_requested()) pending_.end();
  }

  [[nodiscard]] int status() const {
    if (n_added_ > 0) return static_cast<int>(ExitStatus::ok);
    if (n_refused_ > 0) return static_cast<int>(ExitStatus::input);
    fmt::print("nothing new in {}{}\n", options_.watch.folder.string(),
               n_unfinished_ > 0 ? fmt::format("; {} still being written", n_unfinished_) : "");
    return static_cast<int>(ExitStatus::nothing_new);
  }

  const WatchOptions& options_;
  std::unique_ptr<Log> log_ = make_console_log();
  std::stop_token stop_ = base::interrupt_token();
  Pending pending_;
  ingest::Watcher watcher_;
  std::size_t n_added_ = 0, n_refused_ = 0, n_unfinished_ = 0;
};

}  // namespace

void add_watch(cli::App& program, Work& chosen) {
  auto options = std::make_shared<WatchOptions>();
  auto& watch = options->watch;
  watch.import.n_threads = base::available_threads();
  auto* command = program.add_subcommand(
      "watch",
      R"(Import finished exports as they come into a folder. Finished: two looks find the same size and time of change. One bad
file does not keep the others out: it moves to a folder, with the reason beside it. Imported files stay where they are and
are known by their digest; what is no export is left alone and named once. Exit status of --once: 0 cases were added, 3 all were refused, 8 nothing new.)");
  command->add_option("DIR", watch.folder, "Folder to watch")->required()->type_name("DIR");
  command->add_option("--store", watch.import.store, "Snapshot store to create or to add to")
      ->type_name("STORE.h5")
      ->required();
  command->add_option("--mesh", watch.import.mesh, "Reduced mesh; may be left out when the store exists")
      ->type_name("MESH.h5");
  command
      ->add_option("--furnace", watch.import.furnace,
                   "Furnace description of a new store [default: MESH.toml beside the mesh]")
      ->type_name("FURNACE.toml");
  command
      ->add_option("--cases", watch.import.cases, "Table of boundary conditions, for formats that carry none")
      ->type_name("CASES.csv");
  command
      ->add_option(
          "--then", options->command,
          R"(Run after each batch that added cases, by /bin/sh, with ELROM_STORE (the store) and ELROM_ADDED (names,
separated by commas); its failure is told and ends nothing)")
      ->type_name("COMMAND");
  command->add_option("--refused", watch.refused, "Folder for what is refused [default: DIR/refused]")
      ->type_name("DIR");
  command->add_option("--every", options->every, "Time between looks [s] [default: 10; with --once 1]")
      ->type_name("SECONDS")
      ->check(cli::PositiveNumber);
  command->add_flag("--once", options->once, "Look twice, import what is finished, and end");
  add_accept(*command, options->judgement);
  command->add_option("--threads", watch.import.n_threads, "Processor threads")
      ->capture_default_str()
      ->check(cli::PositiveNumber);
  command->callback([options, &chosen] { chosen = [options] { return Watch(*options).run(); }; });
}

}  // namespace elrom::programs
