#pragma once
// Where libraries send messages and progress. Libraries get a Log& and never print by themselves.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace elrom {

enum class Level { detail, info, warning };

/// A piece of long work as the user sees it.
struct Progress {
  std::string task;  ///< "screen pressure"
  std::int64_t done = 0;
  std::int64_t total = 0;  ///< 0: not known
  std::string unit = {};   ///< "columns", "trials"
  std::string best = {};   ///< best value so far, ready to print; empty: none
};

/// Thread rule: every member may be called from any thread.
class Log {
 public:
  virtual ~Log() = default;
  virtual void message(Level level, std::string_view text) = 0;
  /// Called as often as convenient; the sink throttles. done == total ends the task's line.
  virtual void progress(const Progress& progress) = 0;

  void info(std::string_view text) { message(Level::info, text); }
  void warning(std::string_view text) { message(Level::warning, text); }
  void detail(std::string_view text) { message(Level::detail, text); }
};

/// Swallows everything; for tests and for callers who do not care.
Log& silent_log();

/// To standard error: a live line with rate and remaining time on
/// a terminal, plain lines every few seconds otherwise.
/// @param lowest messages below this level are dropped; progress is worth an info
std::unique_ptr<Log> make_console_log(Level lowest = Level::info);

/// Passes everything on to `log`, but each warning once: for work that is done several times over.
std::unique_ptr<Log> warn_once(Log& log);

}  // namespace elrom
