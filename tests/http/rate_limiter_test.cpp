#include "rate_limiter.hpp"

#include <gtest/gtest.h>

namespace elrom::http {
namespace {

TEST(RateLimiter, LetsABurstThroughAndThenTheRate) {
  RateLimiter limiter(2, 3);  // two a second, three at once

  for (int i = 0; i < 3; ++i) EXPECT_EQ(limiter.take("a", 10), 0);
  EXPECT_DOUBLE_EQ(limiter.take("a", 10), 0.5);
  EXPECT_DOUBLE_EQ(limiter.take("a", 10.25), 0.25);
  EXPECT_EQ(limiter.take("a", 10.5), 0);
  EXPECT_GT(limiter.take("a", 10.5), 0);
}

TEST(RateLimiter, CountsEachAddressByItself) {
  RateLimiter limiter(1, 1);

  EXPECT_EQ(limiter.take("a", 0), 0);
  EXPECT_EQ(limiter.take("b", 0), 0);
  EXPECT_GT(limiter.take("a", 0), 0);
}

TEST(RateLimiter, ForgetsAddressesThatRested) {
  RateLimiter limiter(1, 1);

  for (int i = 0; i < 1024; ++i) (void)limiter.take(std::to_string(i), 0);
  EXPECT_EQ(limiter.size(), 1024U);
  (void)limiter.take("late", 100);

  EXPECT_EQ(limiter.size(), 1U);
}

TEST(RateLimiter, LooksForThoseThatRestedOnlyNowAndThen) {
  RateLimiter limiter(1, 1);

  (void)limiter.take("early", 0);
  (void)limiter.take("late", 100);

  EXPECT_EQ(limiter.size(), 2U);
}

}  // namespace
}  // namespace elrom::http
