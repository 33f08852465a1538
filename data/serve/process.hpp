#pragma once
// Another program at work for a request: its crash, and its limits, are no harm to the server.
//
// Thread rule: any thread.

#include <filesystem>
#include <string>
#include <vector>

namespace elrom::serve {

struct Ended {
  bool in_time = true;
  int status = -1;   ///< exit status; -1: a signal ended it
  std::string said;  ///< on standard error, its beginning

  /// The last line without the program's name: "elrom-serve: error: no fields" -> "no fields"
  [[nodiscard]] std::string reason() const;
};

/// Runs a program to its end, or stops it after so many seconds. @throws SystemError when it cannot start
[[nodiscard]] Ended run_process(const std::vector<std::string>& command, int patience_s);

}  // namespace elrom::serve
