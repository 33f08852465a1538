#include "elrom/base/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <vector>

#include "elrom/base/error.hpp"

namespace elrom::base {
namespace {

TEST(ParallelFor, CallsEveryIndexOnce) {
  for (const int n_threads : {1, 2, 7}) {
    std::vector<std::atomic<int>> calls(1000);
    parallel_for(calls.size(), n_threads, [&](std::size_t i, int) { ++calls[i]; });
    for (const auto& count : calls) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelFor, WorkerNumbersStayBelowTheThreadCount) {
  std::atomic<int> highest{0};

  parallel_for(100, 3, [&](std::size_t, int worker) {
    for (int seen = highest; worker > seen && !highest.compare_exchange_weak(seen, worker);) {
    }
  });

  EXPECT_LT(highest, 3);
}

TEST(ParallelFor, PassesTheFirstExceptionOnAndStops) {
  std::atomic<int> calls{0};

  EXPECT_THROW(parallel_for(1000000, 2,
                            [&](std::size_t i, int) {
                              ++calls;
                              if (i == 10) throw InputError("bad");
                            }),
               InputError);

  EXPECT_LT(calls, 1000000);
}

TEST(ParallelFor, StopsOnRequest) {
  std::stop_source source;

  EXPECT_THROW(parallel_for(
                   1000, 2,
                   [&](std::size_t i, int) {
                     if (i == 3) source.request_stop();
                   },
                   source.get_token()),
               Interrupted);
}

TEST(ParallelFor, NothingToDoIsFine) {
  EXPECT_NO_THROW(parallel_for(0, 4, [](std::size_t, int) { FAIL(); }));
}

}  // namespace
}  // namespace elrom::base
