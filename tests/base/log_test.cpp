#include "elrom/base/log.hpp"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include "support/recording_log.hpp"

namespace elrom {
namespace {

using ::testing::HasSubstr;

/// What a console log of that level prints about a task that ends, and a warning.
std::string printed_at(Level lowest) {
  ::testing::internal::CaptureStderr();
  {
    const auto log = make_console_log(lowest);
    log->info("an aside");
    log->warning("look here");
    log->progress({.task = "import", .done = 3, .total = 3, .unit = "cases"});
  }
  return ::testing::internal::GetCapturedStderr();
}

TEST(ConsoleLog, TellsProgressAndMessages) {
  const auto text = printed_at(Level::info);

  EXPECT_THAT(text, HasSubstr("an aside"));
  EXPECT_THAT(text, HasSubstr("import: 3/3 cases"));
}

TEST(ConsoleLog, ATaskThatEndsTellsItsRateAndOneThatBeginsSaysNothingYet) {
  ::testing::internal::CaptureStderr();
  const auto log = make_console_log(Level::info);
  log->progress({.task = "count", .done = 2, .unit = "cases"});  // of how many is not known
  log->progress({.task = "import", .done = 1, .total = 300, .unit = "cases"});
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  log->progress({.task = "import", .done = 300, .total = 300, .unit = "cases"});
  const auto text = ::testing::internal::GetCapturedStderr();

  double rate = 0;
  ASSERT_EQ(std::sscanf(text.c_str(), "import: 300/300 cases, %lf/s, took ", &rate), 1) << text;
  EXPECT_GT(rate, 1);
  EXPECT_LT(rate, 30000.1);
  EXPECT_EQ(std::ranges::count(text, '\n'), 1) << text;
}

TEST(ConsoleLog, QuietOneTellsWarningsAlone) {
  EXPECT_EQ(printed_at(Level::warning), "warning: look here\n");
}

TEST(WarnOnce, SaysAWarningOnceAndAllElseAsOften) {
  test::RecordingLog log;
  const auto once = warn_once(log);
  for (int i = 0; i < 2; ++i) {
    once->warning("look here");
    once->info("an aside");
  }
  once->warning("and there");

  EXPECT_EQ(log.text(), "look here\nan aside\nan aside\nand there\n");
}

}  // namespace
}  // namespace elrom
