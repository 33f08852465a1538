#pragma once
// What a program says and how it ends.

#include <stdio.h>
#include <sys/wait.h>

#include <stdexcept>
#include <string>

namespace elrom::test {

struct Outcome {
  int status = -1;   ///< exit status; -1 when a signal ended it
  std::string text;  ///< standard output, and what else the command sends there
};

/// @param command as the shell takes it; "2>&1" adds the errors to the text
inline Outcome outcome_of(const std::string& command) {
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  if (pipe == nullptr) throw std::runtime_error("cannot start " + command);
  Outcome outcome;
  char buffer[4096];
  for (std::size_t n = 0; (n = std::fread(buffer, 1, sizeof buffer, pipe)) > 0;)
    outcome.text.append(buffer, n);
  const int status = ::pclose(pipe);
  if (WIFEXITED(status)) outcome.status = WEXITSTATUS(status);
  return outcome;
}

}  // namespace elrom::test
