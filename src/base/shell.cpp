#include "elrom/base/shell.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstring>
#include <mutex>
#include <thread>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::base {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::seconds grace{5};

/// Where a program's words go, in memory: nobody waits for a reader, and no disk has to have room.
class Words {
 public:
  explicit Words(bool wanted) : file_(wanted ? ::memfd_create("said", MFD_CLOEXEC) : -1) {
    if (wanted && file_ < 0) throw SystemError("cannot keep what a program says");
  }
  ~Words() {
    if (file_ >= 0) ::close(file_);
  }
  Words(const Words&) = delete;
  Words& operator=(const Words&) = delete;

  [[nodiscard]] int file() const { return file_; }
  [[nodiscard]] std::string last() const {
    constexpr off_t most = 65536;
    if (file_ < 0) return {};
    const auto size = ::lseek(file_, 0, SEEK_END), begin = std::max<off_t>(0, size - most);
    std::string text(static_cast<std::size_t>(size - begin), ' ');
    const auto n = ::pread(file_, text.data(), text.size(), begin);
    text.resize(static_cast<std::size_t>(std::max<ssize_t>(0, n)));
    return text;
  }

 private:
  int file_;
};

/// What the child begins with: a group of its own, so that its children are ended with it, signals as a
/// shell expects them, and none of our files. Not a fork: other threads of ours may hold locks.
class Spawn {
 public:
  Spawn(const ShellOptions& options, int words) {
    ::posix_spawn_file_actions_init(&actions_);
    ::posix_spawnattr_init(&attributes_);
    if (!options.folder.empty()) ::posix_spawn_file_actions_addchdir_np(&actions_, options.folder.c_str());
    const bool kept = words >= 0 || !options.output.empty();
    if (words >= 0)
      ::posix_spawn_file_actions_adddup2(&actions_, words, STDOUT_FILENO);
    else if (kept)
      ::posix_spawn_file_actions_addopen(&actions_, STDOUT_FILENO,
                                         std::filesystem::absolute(options.output).c_str(),
                                         O_WRONLY | O_CREAT | O_TRUNC, 0644);
    if (kept) ::posix_spawn_file_actions_adddup2(&actions_, STDOUT_FILENO, STDERR_FILENO);
    ::posix_spawn_file_actions_addclosefrom_np(&actions_, STDERR_FILENO + 1);
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

  [[nodiscard]] pid_t begin(std::vector<std::string> words, const ShellOptions& options) const {
    auto variables = environment(options);
    pid_t child = -1;
    const int fault = ::posix_spawn(&child, words.front().c_str(), &actions_, &attributes_,
                                    pointers_to(words).data(), pointers_to(variables).data());
    if (fault == 0) return child;
    throw SystemError(Problem{.what = "cannot start '" + join(words, " ") + "'",
                              .where = options.folder.string(),
                              .found = std::strerror(fault)});
  }

 private:
  static std::vector<char*> pointers_to(std::vector<std::string>& texts) {
    std::vector<char*> pointers;
    for (auto& text : texts) pointers.push_back(text.data());
    pointers.push_back(nullptr);
    return pointers;
  }
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

/// A child's end, waited for by a thread of its own, so that it is heard of at once and a stop as well. The
/// child stays a zombie until status(): its number is nobody else's.
class Ending {
 public:
  explicit Ending(pid_t child) : child_(child), waiter_([this] { wait(); }) {}

  /// @return whether it came in time and before the stop
  bool before(double seconds, const std::stop_token& stop) {
    constexpr double a_year_s = 366 * 86400.0;
    std::unique_lock lock(mutex_);
    return came_.wait_for(lock, stop, std::chrono::duration<double>(std::min(seconds, a_year_s)),
                          [this] { return over_; });
  }
  [[nodiscard]] int status() {
    waiter_.join();
    int status = 0;
    while (::waitpid(child_, &status, 0) < 0 && errno == EINTR) {
    }
    return status;
  }

 private:
  void wait() {
    siginfo_t info;
    while (::waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
    }
    const std::scoped_lock lock(mutex_);
    over_ = true;
    came_.notify_all();
  }

  pid_t child_;
  std::mutex mutex_;
  std::condition_variable_any came_;
  bool over_ = false;
  std::jthread waiter_;
};

}  // namespace

std::string ShellEnd::in_words() const {
  if (stopped) return "was stopped";
  if (timed_out) return "took longer than its time";
  if (signal != 0) return "was ended by signal " + std::to_string(signal);
  return status == 0 ? "" : "ended with status " + std::to_string(status);
}

std::string ShellEnd::reason() const {
  const std::string mark = "error: ";
  const auto at = said.rfind(mark);
  if (at == std::string::npos) return split(trim(said), '\n').back();
  return split(said.substr(at + mark.size()), '\n').front();
}

ShellEnd run_program(const std::vector<std::string>& words, const ShellOptions& options,
                     const std::stop_token& stop) {
  const Words said(options.listen);
  const pid_t child = Spawn(options, said.file()).begin(words, options);
  Ending ending(child);
  ShellEnd end;
  if (!ending.before(options.seconds, stop)) {
    end.stopped = stop.stop_requested();
    end.timed_out = !end.stopped;
    ::kill(-child, SIGTERM);
    (void)ending.before(std::chrono::duration<double>(grace).count(), {});
    ::kill(-child, SIGKILL);  // what it began may have stayed behind
  }
  const int status = ending.status();
  end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  end.status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  end.said = said.last();
  return end;
}

ShellEnd run_shell(const std::string& command, const ShellOptions& options, const std::stop_token& stop) {
  return run_program({"/bin/sh", "-c", command}, options, stop);
}

}  // namespace elrom::base
