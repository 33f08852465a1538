#include "processes.hpp"

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>

#include "elrom/base/error.hpp"

extern char** environ;

namespace elrom::benchmark {
namespace {

struct Once {
  double ms, peak_mib;
};

Once run_once(const std::vector<std::string>& words, const posix_spawn_file_actions_t& actions) {
  std::vector<char*> arguments;
  for (const auto& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const auto begin = std::chrono::steady_clock::now();
  pid_t process = 0;
  int status = 0;
  struct rusage usage {};
  const bool started =
      ::posix_spawn(&process, arguments[0], &actions, nullptr, arguments.data(), environ) == 0;
  if (!started || ::wait4(process, &status, 0, &usage) != process || !WIFEXITED(status) ||
      WEXITSTATUS(status) != 0) {
    throw SystemError({.what = "program failed", .where = words[0], .advice = "run it by hand to see why"});
  }
  const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - begin;
  return {elapsed.count(), static_cast<double>(usage.ru_maxrss) / 1024};
}

}  // namespace

Timings time_process(const std::vector<std::string>& words, int repeats) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  if (repeats > 1) run_once(words, actions);
  std::vector<double> ms;
  Timings timings;
  for (int i = 0; i < repeats; ++i) {
    const auto once = run_once(words, actions);
    ms.push_back(once.ms);
    timings.peak_mib = std::max(timings.peak_mib, once.peak_mib);
  }
  posix_spawn_file_actions_destroy(&actions);
  std::sort(ms.begin(), ms.end());
  timings.min_ms = ms.front();
  timings.median_ms = ms[ms.size() / 2];
  return timings;
}

BusyNeighbour::BusyNeighbour() : process_(::fork()) {
  if (process_ != 0) return;
  for (volatile double x = 1;;) x = x * 1.0000001;
}

BusyNeighbour::~BusyNeighbour() {
  if (process_ <= 0) return;
  ::kill(process_, SIGKILL);
  ::waitpid(process_, nullptr, 0);
}

}  // namespace elrom::benchmark
