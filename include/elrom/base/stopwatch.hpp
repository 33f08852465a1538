#pragma once
// Wall time that passed, by a clock that is never set back.
//
// Thread rule: an object is one thread's.

#include <chrono>

namespace elrom::base {

class Stopwatch {
 public:
  /// Seconds since the beginning.
  [[nodiscard]] double seconds() const { return between(begin_, Clock::now()); }
  /// Seconds since the last call, or since the beginning.
  double lap() {
    const auto now = Clock::now(), last = last_;
    last_ = now;
    return between(last, now);
  }

 private:
  using Clock = std::chrono::steady_clock;
  static double between(Clock::time_point begin, Clock::time_point end) {
    return std::chrono::duration<double>(end - begin).count();
  }
  Clock::time_point begin_ = Clock::now(), last_ = begin_;
};

}  // namespace elrom::base
