#pragma once
// Another program at work for us: a command as the shell takes it, or a program with its words. It is ended
// with all that it began when its time is over or nobody wants it any more, and its crash is no harm to us.
//
// Thread rule: any thread.

#include <filesystem>
#include <limits>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

namespace elrom::base {

struct ShellOptions {
  std::filesystem::path folder = {};                    ///< where it runs; empty: here
  std::filesystem::path output = {};                    ///< file for all that it says; empty: where ours goes
  bool listen = false;                                  ///< what it says goes to ShellEnd::said
  std::map<std::string, std::string> environment = {};  ///< beside ours
  double seconds = std::numeric_limits<double>::infinity();
};

struct ShellEnd {
  int status = 0;  ///< exit status; -1 when a signal ended it
  int signal = 0;  ///< that ended it
  bool timed_out = false, stopped = false;
  std::string said = {};  ///< the last 64 KiB, where they were listened to

  [[nodiscard]] bool well() const { return status == 0 && !timed_out && !stopped; }
  /// "ended with status 3", "was ended by signal 11", "took longer than its time"; empty: it ended well
  [[nodiscard]] std::string in_words() const;
  /// The last error of what it said: of "elrom-serve: error: no fields" "no fields"; else its last line
  [[nodiscard]] std::string reason() const;
};

/// Runs `command` by /bin/sh and waits for its end. At a stop, or when its time is over, it and its children
/// get SIGTERM, and SIGKILL five seconds later.
/// @throws SystemError when it cannot be started
ShellEnd run_shell(const std::string& command, const ShellOptions& options, const std::stop_token& stop = {});
/// The same for a program's file and its arguments, which nobody reads anything into.
ShellEnd run_program(const std::vector<std::string>& words, const ShellOptions& options,
                     const std::stop_token& stop = {});

}  // namespace elrom::base
