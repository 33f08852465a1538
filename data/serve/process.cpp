#include "process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::serve {
namespace {

struct Pipe {
  std::array<int, 2> ends{-1, -1};
  Pipe() {
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) throw SystemError("cannot make a pipe");
  }
  ~Pipe() {
    close_end(0);
    close_end(1);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;
  void close_end(std::size_t i) {
    if (ends[i] >= 0) ::close(std::exchange(ends[i], -1));
  }
};

/// Not a fork of this process: other threads of it may hold the locks that the work needs.
pid_t begin(const std::vector<std::string>& command, int errors) {
  std::vector<char*> arguments;
  for (const auto& word : command) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, errors, STDERR_FILENO);
  ::posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);  // no caller of ours, nor our port
  pid_t process = -1;
  const int fault = ::posix_spawn(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (fault != 0) throw SystemError(Problem{.what = "cannot start a process", .where = command[0]});
  return process;
}

/// What it says until it ends. @return false: it did not end in time
bool listen(int pipe, int patience_s, std::string& said) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::seconds(patience_s);
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) return false;
    pollfd one{pipe, POLLIN, 0};
    if (::poll(&one, 1, static_cast<int>(left)) <= 0) continue;
    char bytes[4096];
    const auto n = ::read(pipe, bytes, sizeof bytes);
    if (n == 0) return true;
    if (n > 0 && said.size() < 65536) said.append(bytes, static_cast<std::size_t>(n));
  }
}

}  // namespace

std::string Ended::reason() const {
  const auto lines = base::split(base::trim(said), '\n');
  const std::string mark = "error: ";
  const auto at = lines.back().find(mark);
  return at == std::string::npos ? lines.back() : lines.back().substr(at + mark.size());
}

Ended run_process(const std::vector<std::string>& command, int patience_s) {
  Pipe pipe;
  const pid_t process = begin(command, pipe.ends[1]);
  pipe.close_end(1);
  Ended ended;
  ended.in_time = listen(pipe.ends[0], patience_s, ended.said);
  if (!ended.in_time) ::kill(process, SIGKILL);
  int status = 0;
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  if (WIFEXITED(status)) ended.status = WEXITSTATUS(status);
  return ended;
}

}  // namespace elrom::serve
