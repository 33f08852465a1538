#pragma once
// What every benchmark's main shares: its command line, a clock, and the programs beside it.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/stopwatch.hpp"
#include "elrom/base/version.hpp"
#include "elrom/cli/cli.hpp"

namespace elrom::benchmark {

using base::Stopwatch;

/// A command line.
class CommandLine {
 public:
  explicit CommandLine(const std::string& what);

  enum class Need { optional, required };
  void add(const std::string& name, bool& value, const std::string& help);
  void add(const std::string& name, int& value, const std::string& help);
  void add(const std::string& name, std::string& value, const std::string& help, Need need = Need::optional);
  void add(const std::string& name, std::filesystem::path& value, const std::string& help,
           Need need = Need::optional);
  /// values separated by commas
  void add_list(const std::string& name, std::vector<std::string>& values, const std::string& help);
  /// one value each time the option is given
  void add_repeated(const std::string& name, std::vector<std::string>& values, const std::string& help);

  /// @return the exit status where the program ends here: --help. @throws UsageError
  [[nodiscard]] std::optional<int> parse(int argc, char** argv);

 private:
  cli::App app_;
};

/// Options that every benchmark has.
struct Arguments {
  std::filesystem::path json, store;
  bool small = false;
  int threads = base::available_threads();

  void add_to(CommandLine& line, const std::string& store_help,
              CommandLine::Need store_need = CommandLine::Need::optional);
};

/// Options of those that train studies and have them judged.
struct StudyArguments : Arguments {
  std::string effort = "quick";
  std::vector<std::string> settings;
  std::filesystem::path folder;  ///< empty: one that is removed

  void add_to(CommandLine& line);
};

/// A program of the same build, by its name.
inline std::filesystem::path sibling(const std::string& program) {
  const auto path = std::filesystem::read_symlink("/proc/self/exe").parent_path() / program;
  if (!std::filesystem::exists(path)) {
    throw NotBuiltError({.what = "this benchmark needs the program " + program,
                         .where = path.parent_path().string(),
                         .advice = "build it first"});
  }
  return path;
}

/// Runs a program to its end. @throws SystemError when it does not end with 0
/// @return its resource usage; ru_maxrss in KiB
inline rusage run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  const auto text = program.string();
  std::vector<char*> argv{const_cast<char*>(text.c_str())};
  for (const auto& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  const pid_t child = ::fork();
  if (child == 0) {
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || ::wait4(child, &status, 0, &usage) != child || !WIFEXITED(status) ||
      WEXITSTATUS(status) != 0) {
    throw SystemError({.what = "a program failed", .where = text});
  }
  return usage;
}

/// `elrom-train run` in `folder` on a store, and `elrom-report accuracy` of it; a folder that is there goes
/// on from where it was.
/// @param further settings, "key=value", before those of the arguments @return the report
nlohmann::ordered_json trained_report(const StudyArguments& arguments, const std::filesystem::path& folder,
                                      const std::filesystem::path& store,
                                      const std::vector<std::string>& further = {});

/// A store of the full size, or of a small one, from elrom-data generate.
inline std::filesystem::path generate_store(const std::filesystem::path& folder, bool small) {
  const auto store = folder / "snapshots.h5";
  run_program(sibling("elrom-data"),
              {"generate", "--cases", small ? "20" : "249", "--planes", small ? "6" : "66", "--columns",
               small ? "40" : "840", "--fields", small ? "2" : "9", "--inputs", "26", "--seed", "1",
               "--store", store.string()});
  return store;
}

/// Prints the figures, with the version and whether they are --small; writes them to `file` where it has a
/// name. @return 0
int show(nlohmann::ordered_json json, bool small, const std::filesystem::path& file);

/// Body of a benchmark's main: parses, measures, prints and writes the figures.
int benchmark_main(const std::string& name, const std::string& what, const std::string& store_help, int argc,
                   char** argv, const std::function<nlohmann::ordered_json(const Arguments&)>& measure);

}  // namespace elrom::benchmark
