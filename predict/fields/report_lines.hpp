#pragma once
// One line a case to the user, in the order of the table whatever order the cases are done in.

#include <cstdio>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace elrom::fields {

/// Thread rule: any thread.
class ReportLines {
 public:
  ReportLines(std::size_t n, std::FILE* stream) : lines_(n), stream_(stream) {}

  /// An empty line is not printed.
  void add(std::size_t i, std::string line) {
    const std::scoped_lock lock(mutex_);
    lines_[i] = std::move(line);
    for (; next_ < lines_.size() && lines_[next_]; ++next_) {
      if (lines_[next_]->empty()) continue;
      std::fputs(lines_[next_]->c_str(), stream_);
      std::fputc('\n', stream_);
      lines_[next_]->clear();
    }
  }

 private:
  std::mutex mutex_;
  std::vector<std::optional<std::string>> lines_;
  std::size_t next_ = 0;
  std::FILE* stream_;
};

}  // namespace elrom::fields
