#pragma once
// Programs under test, run as a user would: started, killed, waited for.

#include <sys/types.h>

#include <chrono>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace elrom::faults {

struct Exit {
  int status = -1;  ///< exit status, or -1 when a signal ended it
  int signal = 0;   ///< 0: it ended by itself
  bool timed_out = false;
  std::string output;  ///< of standard output and error, when it was captured
  double seconds = 0;
};

/// A program in a process of its own; killed with the object.
class Process {
 public:
  /// @param command program and arguments @param environment added to ours
  explicit Process(const std::vector<std::string>& command,
                   const std::map<std::string, std::string>& environment = {});
  ~Process();
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;

  void kill(int signal) const;
  /// @param most_seconds beyond them it is killed, and told as timed_out
  Exit wait(double most_seconds = 120);

 private:
  pid_t id_ = -1;
  std::filesystem::path output_;
  std::chrono::steady_clock::time_point start_;
};

/// Start and wait.
Exit run(const std::vector<std::string>& command, const std::map<std::string, std::string>& environment = {});

}  // namespace elrom::faults
