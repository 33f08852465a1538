#include "elrom/base/parallel.hpp"

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <cfenv>
#include <latch>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "elrom/base/child_process.hpp"
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

/// The threads, the caller's among them, of a call that cannot end before all of them take part.
std::set<pid_t> threads_of_a_call(int n_threads) {
  std::vector<pid_t> threads(static_cast<std::size_t>(n_threads));
  std::latch all_here(n_threads);
  parallel_for(threads.size(), n_threads, [&](std::size_t i, int) {
    threads[i] = ::gettid();
    all_here.arrive_and_wait();
  });
  return {threads.begin(), threads.end()};
}

TEST(ParallelFor, TheNextCallHasTheSameThreads) {
  const auto first = threads_of_a_call(3);

  EXPECT_EQ(first.size(), 3U);
  EXPECT_EQ(threads_of_a_call(3), first);
  EXPECT_TRUE(first.contains(::gettid()));
}

TEST(ParallelFor, TheTeamOutlivesAnException) {
  const auto first = threads_of_a_call(2);
  std::latch both_here(2);
  EXPECT_THROW(parallel_for(2, 2,
                            [&](std::size_t, int) {
                              both_here.arrive_and_wait();
                              throw InputError("bad");
                            }),
               InputError);

  EXPECT_EQ(threads_of_a_call(2), first);
}

TEST(ParallelFor, CallsInsideCallsAndFromSeveralThreadsAtOnceComeToAnEnd) {
  std::atomic<int> calls{0};
  {
    std::vector<std::jthread> callers;
    for (int caller = 0; caller < 4; ++caller)
      callers.emplace_back([&] {
        for (int time = 0; time < 50; ++time)
          parallel_for(3, 3,
                       [&](std::size_t, int) { parallel_for(5, 2, [&](std::size_t, int) { ++calls; }); });
      });
  }
  EXPECT_EQ(calls, 4 * 50 * 3 * 5);
}

TEST(ParallelFor, AForkedChildHasATeamOfItsOwn) {
#if defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the thread sanitizer has no threads after a fork";
#endif
  const auto before = threads_of_a_call(3);

  EXPECT_NO_THROW(try_in_child("the team", "child",
                               [] { check(threads_of_a_call(3).size() == 3, "three threads"); },
                               {.seconds = 20, .memory_bytes = std::size_t{1} << 30}));
  EXPECT_EQ(threads_of_a_call(3), before);
}

TEST(ParallelFor, AllThreadsCountAsTheCallerDoes) {
  static_cast<void>(threads_of_a_call(2));
  const int before = std::fegetround();
  std::vector<int> rounding(2);
  std::latch both_here(2);
  std::fesetround(FE_UPWARD);
  parallel_for(2, 2, [&](std::size_t i, int) {
    rounding[i] = std::fegetround();
    both_here.arrive_and_wait();
  });
  std::fesetround(before);

  EXPECT_EQ(rounding, std::vector<int>(2, FE_UPWARD));
}

TEST(ParallelFor, WorkersFollowTheirCallersProcessors) {
  if (available_threads() < 2) GTEST_SKIP() << "one processor: nothing to be confined to";
  std::latch both(2);
  parallel_for(2, 2, [&](std::size_t, int) { both.arrive_and_wait(); });  // a worker that may go anywhere
  std::vector<int> allowed(2);

  std::thread confined([&] {
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
    ASSERT_EQ(sched_setaffinity(0, sizeof one, &one), 0);
    std::latch again(2);
    parallel_for(2, 2, [&](std::size_t i, int) {
      again.arrive_and_wait();
      cpu_set_t own;
      sched_getaffinity(0, sizeof own, &own);
      allowed[i] = CPU_COUNT(&own);
    });
  });
  confined.join();

  EXPECT_EQ(allowed, std::vector<int>(2, 1));
}

}  // namespace
}  // namespace elrom::base
