#include "elrom/base/app.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>

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

}  // namespace
}  // namespace elrom::base
