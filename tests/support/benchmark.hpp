#pragma once
// What every benchmark's main shares: its command line, a clock, and the programs beside it.

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "elrom/base/app.hpp"
#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/version.hpp"

namespace elrom::benchmark {

class Stopwatch {
 public:
  [[nodiscard]] double seconds() const {
    return std::chrono::duration<double>(Clock::now() - begin_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point begin_ = Clock::now();
};

/// Options that every benchmark has.
struct Arguments {
  std::filesystem::path json, store;
  bool small = false;
  int threads = base::available_threads();

  void add_to(CLI::App& app, const std::string& store_help) {
    app.add_option("--json", json, "write the figures to this file");
    app.add_option("--store", store, store_help);
    app.add_flag("--small", small, "a version that ends within a minute");
    app.add_option("--threads", threads, "threads of the work that is measured")->capture_default_str();
  }
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

/// A store of the full size, or of a small one, from elrom-data generate.
inline std::filesystem::path generate_store(const std::filesystem::path& folder, bool small) {
  const auto store = folder / "snapshots.h5";
  run_program(sibling("elrom-data"),
              {"generate", "--cases", small ? "20" : "249", "--planes", small ? "6" : "66", "--columns",
               small ? "40" : "840", "--fields", small ? "2" : "9", "--inputs", "26", "--seed", "1",
               "--store", store.string()});
  return store;
}

/// Body of a benchmark's main: parses, measures, prints and writes the figures.
template <class Measure>
int benchmark_main(const std::string& name, const std::string& what, const std::string& store_help, int argc,
                   char** argv, const Measure& measure) {
  return base::run_app(name, [&] {
    CLI::App app(what);
    Arguments arguments;
    arguments.add_to(app, store_help);
    try {
      app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
      return app.exit(error) == 0 ? 0 : static_cast<int>(ExitStatus::usage);
    }
    nlohmann::ordered_json json = measure(arguments);
    json["program"] = program_version();
    json["small"] = arguments.small;
    const auto text = json.dump(1) + "\n";
    std::fputs(text.c_str(), stdout);
    if (!arguments.json.empty()) base::write_text(arguments.json, text);
    return 0;
  });
}

}  // namespace elrom::benchmark
