#include "elrom/base/app.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "elrom/base/error.hpp"

namespace elrom::base {
namespace {

TEST(RunApp, TurnsErrorsIntoOneLineAndTheirStatus) {
  testing::internal::CaptureStderr();

  const int status = run_app("elrom-x", []() -> int { throw InputError("no such field"); });

  EXPECT_EQ(status, 3);
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "elrom-x: error: no such field\n");
}

TEST(RunApp, NamesTheFileThatTheSystemRefused) {
  testing::internal::CaptureStderr();

  const int status = run_app("elrom-x", []() -> int {
    std::filesystem::create_directories("/proc/self/stat/folder");
    return 0;
  });

  EXPECT_EQ(status, 1);
  EXPECT_EQ(testing::internal::GetCapturedStderr(),
            "elrom-x: error: /proc/self/stat/folder: Not a directory\n");
}

TEST(RunApp, PassesTheBodysStatusOn) {
  EXPECT_EQ(run_app("x", [] { return 4; }), 4);
}

TEST(RunApp, TreatsForeignExceptionsAsInternal) {
  testing::internal::CaptureStderr();

  EXPECT_EQ(run_app("x", []() -> int { throw std::runtime_error("odd"); }), 1);
  EXPECT_EQ(run_app("x", []() -> int { throw std::bad_alloc(); }), 1);
  EXPECT_EQ(run_app("x", []() -> int { throw 7; }), 1);

  EXPECT_NE(testing::internal::GetCapturedStderr().find("out of memory"), std::string::npos);
}

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

/// Pages that the system clears for 40 MB, more than glibc keeps by itself.
long cleared_pages() {
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  const std::vector<char> memory(40'000'000, 'a');
  getrusage(RUSAGE_SELF, &after);
  return after.ru_minflt - before.ru_minflt;
}

TEST(KeepFreedMemory, IsNotClearedAgain) {
  const auto in_a_child = [] {
    keep_freed_memory();
    const long first = cleared_pages(), second = cleared_pages();
    std::exit(10 * second < first ? 0 : 1);
  };
  EXPECT_EXIT(in_a_child(), testing::ExitedWithCode(0), "");
}

#endif

}  // namespace
}  // namespace elrom::base
