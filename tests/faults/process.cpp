#include "process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace elrom::faults {
namespace {

std::filesystem::path new_output_file() {
  auto pattern = (std::filesystem::temp_directory_path() / "elrom-output-XXXXXX").string();
  const int descriptor = mkstemp(pattern.data());
  if (descriptor < 0) throw std::runtime_error("no temporary file");
  close(descriptor);
  return pattern;
}

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

Process::Process(const std::vector<std::string>& command,
                 const std::map<std::string, std::string>& environment)
    : output_(new_output_file()), start_(std::chrono::steady_clock::now()) {
  std::vector<char*> arguments;
  for (const auto& part : command) arguments.push_back(const_cast<char*>(part.c_str()));
  arguments.push_back(nullptr);
  id_ = fork();
  if (id_ < 0) throw std::runtime_error("cannot fork");
  if (id_ > 0) return;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const int out = open(output_.c_str(), O_WRONLY | O_TRUNC);
  dup2(out, STDOUT_FILENO);
  dup2(out, STDERR_FILENO);
  for (const auto& [name, value] : environment) setenv(name.c_str(), value.c_str(), 1);
  execv(arguments[0], arguments.data());
  _exit(127);
}

Process::~Process() {
  if (id_ > 0) {
    ::kill(id_, SIGKILL);
    waitpid(id_, nullptr, 0);
  }
  std::error_code ignored;
  std::filesystem::remove(output_, ignored);
}

void Process::kill(int signal) const {
  if (id_ > 0) ::kill(id_, signal);
}

Exit Process::wait(double most_seconds) {
  Exit result;
  int status = 0;
  for (;;) {
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (waitpid(id_, &status, WNOHANG) == id_) {
      result.seconds = seconds;
      break;
    }
    if (!result.timed_out && seconds > most_seconds) {
      result.timed_out = true;
      ::kill(id_, SIGKILL);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(500));
  }
  id_ = -1;
  if (WIFEXITED(status))
    result.status = WEXITSTATUS(status);
  else
    result.signal = WTERMSIG(status);
  result.output = text_of(output_);
  return result;
}

Exit run(const std::vector<std::string>& command, const std::map<std::string, std::string>& environment) {
  return Process(command, environment).wait();
}

}  // namespace elrom::faults
