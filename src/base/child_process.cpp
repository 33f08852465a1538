#include "elrom/base/child_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"

namespace elrom::base {
namespace {

// Exit statuses of the child; everything else is a crash.
constexpr int done = 0, refused = 101, out_of_memory = 102;

constexpr bool address_space_may_be_limited() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return false;  // sanitizers map terabytes of shadow memory
#else
  return true;
#endif
}

void limit_child(const ChildLimits& limits) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  const rlimit no_core{0, 0};
  setrlimit(RLIMIT_CORE, &no_core);
  for (const int signal : {SIGSEGV, SIGBUS, SIGFPE, SIGABRT, SIGILL, SIGINT, SIGTERM})
    std::signal(signal, SIG_DFL);
  // The C library's last words ("double free ...") would only confuse: the parent tells what happened.
  const int null = open("/dev/null", O_WRONLY);
  if (null >= 0) dup2(null, STDERR_FILENO);
  std::size_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  if (!address_space_may_be_limited() || pages == 0) return;
  const rlim_t bytes = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + limits.memory_bytes;
  const rlimit memory{bytes, bytes};
  setrlimit(RLIMIT_AS, &memory);
}

[[noreturn]] void run_child(int report, const std::function<void()>& work, const ChildLimits& limits) {
  limit_child(limits);
  int status = done;
  try {
    work();
  } catch (const std::bad_alloc&) {
    status = out_of_memory;
  } catch (const std::exception& error) {
    status = refused;
    // A message that does not fit the pipe's buffer is cut; nobody reads on if the parent is gone.
    if (write(report, error.what(), std::strlen(error.what())) < 0) status = refused;
  }
  _exit(status);  // no exit handlers: they belong to the parent
}

/// What the child wrote, until it closed the pipe. @return false when `seconds` passed before
bool read_report(int pipe, double seconds, std::string& report) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0) return false;
    pollfd wait{pipe, POLLIN, 0};
    const int ready = poll(&wait, 1, static_cast<int>(std::min<long long>(left, 1000)));
    if (ready < 0 && errno != EINTR) return false;
    if (ready <= 0) continue;
    char bytes[4096];
    const auto got = read(pipe, bytes, sizeof bytes);
    if (got == 0) return true;
    if (got > 0) report.append(bytes, static_cast<std::size_t>(got));
  }
}

int wait_for(pid_t child) {
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

[[noreturn]] void throw_for(int status, const std::string& culprit, const std::string& where,
                            const std::string& report, const ChildLimits& limits) {
  if (WIFEXITED(status) && WEXITSTATUS(status) == refused) throw InputError(report);
  if (WIFEXITED(status) && WEXITSTATUS(status) == out_of_memory) {
    throw InputError({.what = "file asks for too much memory",
                      .where = where,
                      .expected = "at most " + std::to_string(limits.memory_bytes >> 20) + " MiB"});
  }
  const std::string how = WIFSIGNALED(status) ? strsignal(WTERMSIG(status)) : "unexpected end";
  throw InputError({.what = culprit + " crashed on this file",
                    .where = where,
                    .found = how,
                    .advice = "the file is damaged or was made to do harm"});
}

}  // namespace

void try_in_child(const std::string& culprit, const std::string& where, const std::function<void()>& work,
                  const ChildLimits& limits) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw SystemError({.what = "cannot make a pipe", .found = std::strerror(errno)});
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    throw SystemError({.what = "cannot start a process", .found = std::strerror(errno)});
  }
  if (child == 0) {
    close(ends[0]);
    run_child(ends[1], work, limits);
  }
  close(ends[1]);
  std::string report;
  const bool in_time = read_report(ends[0], limits.seconds, report);
  close(ends[0]);
  if (!in_time) kill(child, SIGKILL);
  const int status = wait_for(child);
  if (!in_time) {
    throw InputError({.what = culprit + " does not come to an end with this file",
                      .where = where,
                      .expected = "at most " + duration(limits.seconds)});
  }
  if (!WIFEXITED(status) || WEXITSTATUS(status) != done) throw_for(status, culprit, where, report, limits);
}

}  // namespace elrom::base
