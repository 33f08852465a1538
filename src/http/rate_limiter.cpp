#include "rate_limiter.hpp"

#include <algorithm>

namespace elrom::http {

double RateLimiter::take(const std::string& address, double now) {
  const std::scoped_lock lock(mutex_);
  if (buckets_.size() >= next_cleaning_) forget_full(now);
  auto& bucket = buckets_.try_emplace(address, Bucket{burst_, now}).first->second;
  bucket.tokens = std::min(burst_, bucket.tokens + rate_ * (now - bucket.at));
  bucket.at = now;
  if (bucket.tokens < 1) return (1 - bucket.tokens) / rate_;
  bucket.tokens -= 1;
  return 0;
}

std::size_t RateLimiter::size() const {
  const std::scoped_lock lock(mutex_);
  return buckets_.size();
}

/// A bucket that is full again is as good as none, so that many addresses do not eat the memory.
void RateLimiter::forget_full(double now) {
  std::erase_if(buckets_, [&](const auto& entry) {
    return entry.second.tokens + rate_ * (now - entry.second.at) >= burst_;
  });
  next_cleaning_ = std::max<std::size_t>(1024, 2 * buckets_.size());
}

}  // namespace elrom::http
