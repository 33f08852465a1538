#pragma once
// A command as the shell takes it, in a folder of its own choice, ended with all that it began when its time
// is over or nobody wants it any more.
//
// Thread rule: any thread.

#include <filesystem>
#include <limits>
#include <map>
#include <stop_token>
#include <string>

namespace elrom::base {

struct ShellOptions {
  std::filesystem::path folder = {};                    ///< where it runs; empty: here
  std::filesystem::path output = {};                    ///< file for all that it says; empty: where ours goes
  std::map<std::string, std::string> environment = {};  ///< beside ours
  double seconds = std::numeric_limits<double>::infinity();
};

struct ShellEnd {
  int status = 0;  ///< exit status; -1 when a signal ended it
  int signal = 0;  ///< that ended it
  bool timed_out = false, stopped = false;

  [[nodiscard]] bool well() const { return status == 0 && !timed_out && !stopped; }
  /// "ended with status 3", "was ended by signal 11", "took longer than its time"; empty: it ended well
  [[nodiscard]] std::string in_words() const;
};

/// Runs `command` by /bin/sh and waits for its end. At a stop, or when its time is over, it and its children
/// get SIGTERM, and SIGKILL five seconds later.
/// @throws SystemError when it cannot be started
ShellEnd run_shell(const std::string& command, const ShellOptions& options, const std::stop_token& stop);

}  // namespace elrom::base
