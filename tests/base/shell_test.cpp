#include "elrom/base/shell.hpp"

#include <gmock/gmock.h>

#include <chrono>
#include <fstream>
#include <thread>

#include "elrom/base/error.hpp"
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

TEST(Shell, ListensToAProgramWhoseWordsItDoesNotRead) {
  const auto end = run_program({"/bin/echo", "$HOME; *", "a  b"}, {.listen = true});

  EXPECT_TRUE(end.well());
  EXPECT_EQ(end.said, "$HOME; * a  b\n");
  EXPECT_EQ(run_shell("echo 'elrom-x: error: no fields' >&2; exit 3", {.listen = true}).reason(),
            "no fields");
  EXPECT_EQ(run_shell("yes | head -c 100000; echo end", {.listen = true}).said.size(), 65536U);
  EXPECT_EQ(run_shell("true", {.listen = true}).reason(), "");
}

TEST(Shell, TheChildHasNoneOfOurFiles) {
  const test::TemporaryFolder folder;
  folder.write("ours", "x");
  const std::ifstream ours(folder / "ours");

  EXPECT_THAT(run_shell("ls -l /proc/self/fd", {.listen = true}).said,
              ::testing::Not(::testing::HasSubstr("ours")));
}

TEST(Shell, AnEndIsSeenAtOnce) {
  constexpr int n = 20;
  double shortest_s = 1;
  for (int i = 0; i < n; ++i) {
    const auto begin = std::chrono::steady_clock::now();
    (void)run_shell("true", {});
    shortest_s =
        std::min(shortest_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  }
  EXPECT_LT(shortest_s, 0.015);  // an upload waits for it
}

TEST(Shell, WhatCannotBeginSaysSo) { EXPECT_THROW((void)run_program({"/nothing/there"}, {}), SystemError); }

}  // namespace
}  // namespace elrom::base
