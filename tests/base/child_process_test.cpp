#include "elrom/base/child_process.hpp"

#include <gmock/gmock.h>
#include <sched.h>

#include <csignal>
#include <vector>

#include "elrom/base/error.hpp"

namespace elrom::base {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

std::string message_of(const std::function<void()>& work, const ChildLimits& limits = {}) {
  try {
    try_in_child("the library", "case.h5", work, limits);
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

TEST(ChildProcess, HarmlessWorkLeavesNoTrace) {
  int touched = 0;

  EXPECT_EQ(message_of([&] { touched = 1; }), "no error");
  EXPECT_EQ(touched, 0);
}

TEST(ChildProcess, CrashBecomesAnInputError) {
  EXPECT_THAT(message_of([] { std::raise(SIGSEGV); }),
              AllOf(HasSubstr("the library crashed"), HasSubstr("case.h5")));
  EXPECT_THAT(message_of([] { std::abort(); }), HasSubstr("crashed"));
  EXPECT_THAT(message_of([] { std::_Exit(3); }), HasSubstr("crashed"));
}

TEST(ChildProcess, EndlessLoopIsCutOff) {
  const auto loop = [] {
    for (;;) sched_yield();
  };

  EXPECT_THAT(message_of(loop, {.seconds = 0.2}), HasSubstr("does not come to an end"));
}

TEST(ChildProcess, ErrorsKeepTheirMessage) {
  EXPECT_EQ(message_of([] { throw InputError(Problem{.what = "wrong rank", .where = "a.h5:fields"}); }),
            "wrong rank in a.h5:fields");
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(ChildProcess, MemoryIsLimited) {
  const auto greedy = [] { std::vector<char> bytes(std::size_t{1} << 30, 'x'); };

  EXPECT_THAT(message_of(greedy, {.memory_bytes = std::size_t{64} << 20}), HasSubstr("too much memory"));
}
#endif

}  // namespace
}  // namespace elrom::base
