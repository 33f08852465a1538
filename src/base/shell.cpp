#include "elrom/base/shell.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <optional>
#include <thread>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::base {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds between_looks{20};
constexpr std::chrono::seconds grace{5};

/// What the child begins with: a group of its own, so that its children are ended with it, and signals as a
/// shell expects them.
class Spawn {
 public:
  explicit Spawn(const ShellOptions& options) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawnattr_init(&attributes_);
    if (!options.folder.empty()) ::posix_spawn_file_actions_addchdir_np(&actions_, options.folder.c_str());
    if (!options.output.empty()) {
      const auto file = std::filesystem::absolute(options.output).string();
      ::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO, file.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                         0644);
      ::posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
    }
    sigset_t usual;
    ::sigemptyset(&usual);
    for (const int signal : {SIGINT, SIGTERM, SIGPIPE}) ::sigaddset(&usual, signal);
    ::posix_spawnattr_setsigdefault(&attributes_, &usual);
    ::posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  }
  ~Spawn() {
    ::posix_spawn_file_actions_destroy(&actions_);
    ::posix_spawnattr_destroy(&attributes_);
  }
  Spawn(const Spawn&) = delete;
  Spawn& operator=(const Spawn&) = delete;

  [[nodiscard]] pid_t begin(const std::string& command, const ShellOptions& options) const {
    auto variables = environment(options);
    std::vector<char*> pointers;
    for (auto& variable : variables) pointers.push_back(variable.data());
    pointers.push_back(nullptr);
    std::string shell = "sh", flag = "-c", text = command;
    char* const arguments[] = {shell.data(), flag.data(), text.data(), nullptr};
    pid_t child = -1;
    const int fault = ::posix_spawn(&child, "/bin/sh", &actions_, &attributes_, arguments, pointers.data());
    if (fault == 0) return child;
    throw SystemError(Problem{.what = "cannot start '" + command + "'",
                              .where = options.folder.string(),
                              .found = std::strerror(fault)});
  }

 private:
  static std::vector<std::string> environment(const ShellOptions& options) {
    std::vector<std::string> variables;
    for (char** one = environ; *one != nullptr; ++one) {
      const std::string variable = *one;
      if (!options.environment.contains(variable.substr(0, variable.find('='))))
        variables.push_back(variable);
    }
    for (const auto& [name, value] : options.environment) variables.push_back(name + "=" + value);
    return variables;
  }

  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

}  // namespace

std::string ShellEnd::in_words() const {
  if (stopped) return "was stopped";
  if (timed_out) return "took longer than its time";
  if (signal != 0) return "was ended by signal " + std::to_string(signal);
  return status == 0 ? "" : "ended with status " + std::to_string(status);
}

ShellEnd run_shell(const std::string& command, const ShellOptions& options, const std::stop_token& stop) {
  const pid_t child = Spawn(options).begin(command, options);
  const auto begin = Clock::now();
  ShellEnd end;
  std::optional<Clock::time_point> told;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    const auto now = Clock::now();
    const bool late = std::chrono::duration<double>(now - begin).count() > options.seconds;
    if (!told && (late || stop.stop_requested())) {
      end.stopped = stop.stop_requested();
      end.timed_out = !end.stopped;
      told = now;
      ::kill(-child, SIGTERM);
    }
    if (told && now - *told > grace) ::kill(-child, SIGKILL);
    std::this_thread::sleep_for(between_looks);
  }
  if (told) ::kill(-child, SIGKILL);  // what it began may have stayed behind
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  end.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return end;
}

}  // namespace elrom::base
