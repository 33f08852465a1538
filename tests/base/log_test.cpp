#include "elrom/base/log.hpp"

#include <gmock/gmock.h>

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
