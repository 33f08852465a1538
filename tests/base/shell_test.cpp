#include "elrom/base/shell.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <thread>

#include "support/temporary_folder.hpp"

namespace elrom::base {
namespace {

struct Folder {
  test::TemporaryFolder folder;
  ShellEnd run(const std::string& command, double seconds = 60, const std::stop_token& stop = {}) {
    return run_shell(command,
                     {.folder = folder.path(),
                      .output = folder / "said",
                      .environment = {{"ELROM_WORD", "a word"}},
                      .seconds = seconds},
                     stop);
  }
  [[nodiscard]] std::string said() const { return test::read_bytes(folder / "said"); }
};

TEST(Shell, RunsInTheFolderWithItsEnvironmentAndKeepsWhatIsSaid) {
  Folder one;

  const auto end = one.run("pwd; echo \"$ELROM_WORD\" >&2");

  EXPECT_TRUE(end.well());
  EXPECT_EQ(one.said(), std::filesystem::canonical(one.folder.path()).string() + "\na word\n");
}

TEST(Shell, TellsHowItEnded) {
  Folder one;

  EXPECT_EQ(one.run("true").in_words(), "");
  EXPECT_EQ(one.run("exit 3").in_words(), "ended with status 3");
  EXPECT_EQ(one.run("kill -9 $$").in_words(), "was ended by signal 9");
}

TEST(Shell, EndsWhatTakesTooLongWithAllThatItBegan) {
  Folder one;

  const auto end = one.run("(sleep 1; touch outlived) & sleep 60", 0.2);
  std::this_thread::sleep_for(std::chrono::milliseconds(1300));

  EXPECT_TRUE(end.timed_out);
  EXPECT_EQ(end.in_words(), "took longer than its time");
  EXPECT_FALSE(std::filesystem::exists(one.folder / "outlived"));
}

TEST(Shell, EndsWhatNobodyWantsAnyMore) {
  Folder one;
  std::stop_source stop;
  std::jthread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(200));
    stop.request_stop();
  });

  const auto end = one.run("sleep 60", 60, stop.get_token());

  EXPECT_TRUE(end.stopped);
  EXPECT_FALSE(end.well());
}

}  // namespace
}  // namespace elrom::base
