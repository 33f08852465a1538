#pragma once
// How many requests an address may send: a bucket of tokens for each, filled at a steady rate (token bucket).
//
// Thread rule: any thread.

#include <map>
#include <mutex>
#include <string>

namespace elrom::http {

class RateLimiter {
 public:
  /// @param rate tokens a second @param burst the most that a bucket holds
  RateLimiter(double rate, double burst) : rate_(rate), burst_(burst) {}
  /// Takes a token. @param now [s], never going back @return seconds until there is one; 0: it was taken
  double take(const std::string& address, double now);
  [[nodiscard]] std::size_t size() const;

 private:
  struct Bucket {
    double tokens, at;
  };
  void forget_full(double now);

  double rate_, burst_;
  std::size_t next_cleaning_ = 1024;  //!< addresses
  std::map<std::string, Bucket> buckets_;
  mutable std::mutex mutex_;
};

}  // namespace elrom::http
