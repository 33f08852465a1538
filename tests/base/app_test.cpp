#include "elrom/base/app.hpp"

#include <gtest/gtest.h>

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
