#pragma once
// The program elrom-serve, begun, killed and begun again as a machine would.

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

namespace elrom::test {

class Serving {
 public:
  Serving(std::filesystem::path program, std::vector<std::string> arguments)
      : program_(std::move(program)), arguments_(std::move(arguments)) {
    begin();
  }
  ~Serving() { (void)end(SIGKILL); }
  Serving(const Serving&) = delete;
  Serving& operator=(const Serving&) = delete;

  [[nodiscard]] const std::string& url() const { return url_; }
  [[nodiscard]] pid_t process() const { return process_; }

  /// @return its exit status; -1: a signal ended it
  int end(int signal) {
    if (process_ <= 0) return -1;
    ::kill(process_, signal);
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  /// On the port it had.
  void begin() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    std::vector<std::string> command{program_.string()};
    command.insert(command.end(), arguments_.begin(), arguments_.end());
    command.insert(command.end(), {"--port", port_});
    std::vector<char*> pointers;
    for (auto& word : command) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    ::posix_spawn_file_actions_init(&actions);
    ::posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    const int fault = ::posix_spawn(&process_, pointers[0], &actions, nullptr, pointers.data(), environ);
    ::posix_spawn_file_actions_destroy(&actions);
    ::close(ends[1]);
    const bool listens = fault == 0 && wait_for_address(ends[0]);
    ::close(ends[0]);
    if (!listens) throw std::runtime_error("elrom-serve does not start");
  }

 private:
  bool wait_for_address(int pipe) {
    const std::string mark = "listening at ";
    std::string said;
    pollfd one{pipe, POLLIN, 0};
    while (::poll(&one, 1, 20000) > 0) {
      char bytes[1024];
      const auto n = ::read(pipe, bytes, sizeof bytes);
      if (n <= 0) return false;
      said.append(bytes, static_cast<std::size_t>(n));
      const auto at = said.find(mark), end = said.find('\n', at);
      if (at == std::string::npos || end == std::string::npos) continue;
      if (!url_.empty()) return true;  // others may read it
      url_ = said.substr(at + mark.size(), end - at - mark.size());
      port_ = url_.substr(url_.rfind(':') + 1);
      return true;
    }
    return false;
  }

  std::filesystem::path program_;
  std::vector<std::string> arguments_;
  std::string url_, port_ = "0";
  pid_t process_ = -1;
};

}  // namespace elrom::test
