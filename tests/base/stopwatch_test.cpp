#include "elrom/base/stopwatch.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace elrom::base {
namespace {

TEST(Stopwatch, LapsAddUpToTheTimeSinceTheBeginning) {
  Stopwatch watch;
  std::this_thread::sleep_for(std::chrono::milliseconds(3));
  const double first = watch.lap();
  std::this_thread::sleep_for(std::chrono::milliseconds(3));
  const double before = watch.seconds(), second = watch.lap(), after = watch.seconds();

  EXPECT_GE(first, 0.003);
  EXPECT_GE(second, 0.003);
  EXPECT_GE(first + second, before);
  EXPECT_LE(first + second, after);
}

}  // namespace
}  // namespace elrom::base
