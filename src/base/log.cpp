#include "elrom/base/log.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <mutex>
#include <set>

#include "elrom/base/text.hpp"

namespace elrom {
namespace {

using Clock = std::chrono::steady_clock;

class SilentLog final : public Log {
 public:
  void message(Level, std::string_view) override {}
  void progress(const Progress&) override {}
};

class ConsoleLog final : public Log {
 public:
  explicit ConsoleLog(Level lowest) : lowest_(lowest), live_(isatty(STDERR_FILENO) == 1) {}
  ~ConsoleLog() override { clear_line(); }

  void message(Level level, std::string_view text) override {
    if (level < lowest_) return;
    const std::scoped_lock lock(mutex_);
    clear_line();
    fmt::print(stderr, "{}{}\n", level == Level::warning ? "warning: " : "", text);
  }

  void progress(const Progress& progress) override {
    if (lowest_ > Level::info) return;
    const std::scoped_lock lock(mutex_);
    const auto now = Clock::now();
    const auto [entry, is_new] = tasks_.try_emplace(progress.task, Task{now, now});
    auto& task = entry->second;
    const bool finished = progress.total > 0 && progress.done >= progress.total;
    const auto pause = live_ ? std::chrono::milliseconds(200) : std::chrono::milliseconds(5000);
    if (!finished && (is_new || now - task.shown < pause)) return;
    task.shown = now;
    const std::string line =
        describe(progress, std::chrono::duration<double>(now - task.begin).count(), finished);
    if (live_ && !finished) {
      fmt::print(stderr, "\r\033[K{}", line);
      std::fflush(stderr);
      line_open_ = true;
    } else {
      clear_line();
      fmt::print(stderr, "{}\n", line);
    }
    if (finished) tasks_.erase(entry);
  }

 private:
  struct Task {
    Clock::time_point begin, shown;
  };

  static std::string describe(const Progress& progress, double seconds, bool finished) {
    std::string line = fmt::format("{}: {}", progress.task, progress.done);
    if (progress.total > 0) line += fmt::format("/{}", progress.total);
    if (!progress.unit.empty()) line += " " + progress.unit;
    const double rate = seconds > 0 ? static_cast<double>(progress.done) / seconds : 0;
    if (rate > 0) line += fmt::format(", {:.3g}/s", rate);
    if (finished) {
      line += ", took " + base::duration(seconds);
    } else if (rate > 0 && progress.total > 0) {
      line += ", " + base::duration(static_cast<double>(progress.total - progress.done) / rate) + " left";
    }
    if (!progress.best.empty()) line += ", best " + progress.best;
    return line;
  }

  void clear_line() {
    if (!line_open_) return;
    fmt::print(stderr, "\r\033[K");
    line_open_ = false;
  }

  Level lowest_;
  bool live_;
  bool line_open_ = false;
  std::mutex mutex_;
  std::map<std::string, Task> tasks_;
};

class WarnOnce final : public Log {
 public:
  explicit WarnOnce(Log& log) : log_(log) {}
  void message(Level level, std::string_view text) override {
    if (level == Level::warning && !is_new(text)) return;
    log_.message(level, text);
  }
  void progress(const Progress& progress) override { log_.progress(progress); }

 private:
  bool is_new(std::string_view text) {
    const std::scoped_lock lock(mutex_);
    return said_.emplace(text).second;
  }

  Log& log_;
  std::mutex mutex_;
  std::set<std::string> said_;
};

}  // namespace

Log& silent_log() {
  static SilentLog log;
  return log;
}

std::unique_ptr<Log> make_console_log(Level lowest) { return std::make_unique<ConsoleLog>(lowest); }
std::unique_ptr<Log> warn_once(Log& log) { return std::make_unique<WarnOnce>(log); }

}  // namespace elrom
