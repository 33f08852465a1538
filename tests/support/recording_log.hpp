#pragma once
// A log that keeps what it is told.

#include <mutex>
#include <string>

#include "elrom/base/log.hpp"

namespace elrom::test {

/// Messages of a level and above, one a line.
class RecordingLog final : public Log {
 public:
  explicit RecordingLog(Level lowest = Level::info) : lowest_(lowest) {}
  void message(Level level, std::string_view text) override {
    if (level < lowest_) return;
    const std::scoped_lock lock(mutex_);
    text_.append(text).append("\n");
  }
  void progress(const Progress&) override {}
  [[nodiscard]] std::string text() const {
    const std::scoped_lock lock(mutex_);
    return text_;
  }

 private:
  Level lowest_;
  mutable std::mutex mutex_;
  std::string text_;
};

}  // namespace elrom::test
