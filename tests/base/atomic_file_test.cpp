#include "elrom/base/atomic_file.hpp"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "elrom/base/error.hpp"

namespace elrom::base {
namespace {

namespace fs = std::filesystem;

class AtomicFileTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("elrom-atomic-" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  [[nodiscard]] std::ptrdiff_t n_files() const {
    return std::distance(fs::directory_iterator(folder_), fs::directory_iterator());
  }
  fs::path folder_;
};

TEST_F(AtomicFileTest, WithoutCommitTheOldFileStaysAndNoTemporaryIsLeft) {
  const auto target = folder_ / "a.txt";
  write_text(target, "old");

  {
    AtomicFile file(target);
    std::ofstream(file.temporary()) << "half";
  }

  EXPECT_EQ(read_text(target), "old");
  EXPECT_EQ(n_files(), 1);
}

TEST_F(AtomicFileTest, CommitReplacesTheTarget) {
  const auto target = folder_ / "a.txt";
  write_text(target, "old");

  write_text(target, "new");

  EXPECT_EQ(read_text(target), "new");
  EXPECT_EQ(n_files(), 1);
}

TEST_F(AtomicFileTest, TwoWritersOfOneTargetDoNotShareATemporary) {
  const AtomicFile first(folder_ / "a.txt");
  const AtomicFile second(folder_ / "a.txt");

  EXPECT_NE(first.temporary(), second.temporary());
}

TEST_F(AtomicFileTest, MissingFolderIsToldAtOnce) {
  EXPECT_THROW(AtomicFile(folder_ / "missing" / "a.txt"), SystemError);
}

TEST_F(AtomicFileTest, WhatIsNoFileIsNotReplaced) {
  const auto pipe = folder_ / "pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);

  EXPECT_THROW(write_text(pipe, "text"), SystemError);
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST_F(AtomicFileTest, WhatCannotBeWrittenIsKnownBeforeTheWork) {
  EXPECT_NO_THROW(expect_writable(folder_ / "made/on the way/a.txt"));
  EXPECT_EQ(n_files(), 1) << "the folder";
  EXPECT_TRUE(fs::is_empty(folder_ / "made/on the way"));

  write_text(folder_ / "file", "x");
  EXPECT_THROW(expect_writable(folder_ / "file/a.txt"), SystemError);
  EXPECT_THROW(expect_writable(folder_ / "made"), SystemError);
}

/// A process id that was somebody's and is nobody's now.
pid_t dead_process() {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ::waitpid(child, nullptr, 0);
  return child;
}

TEST_F(AtomicFileTest, RemainsOfTheDeadAreRemovedAndThoseOfTheLivingStay) {
  const auto named = [&](const std::string& target, pid_t process) {
    return folder_ / ("." + target + "." + std::to_string(process) + ".0.tmp");
  };
  const auto dead = dead_process();
  write_text(named("12.5", dead), "half");
  fs::create_directories(named("0", dead) / "lagrangian");
  write_text(named("0", dead) / "lagrangian" / "U", "half");
  write_text(named("other", dead), "half");
  write_text(named("12.5", ::getpid()), "half");
  write_text(folder_ / ".12.5.tmp", "the user's");

  remove_dead_remains(folder_, [](std::string_view target) { return target == "12.5" || target == "0"; });

  EXPECT_FALSE(fs::exists(named("12.5", dead)));
  EXPECT_FALSE(fs::exists(named("0", dead)));
  EXPECT_TRUE(fs::exists(named("other", dead)));
  EXPECT_TRUE(fs::exists(named("12.5", ::getpid())));
  EXPECT_TRUE(fs::exists(folder_ / ".12.5.tmp"));
}

TEST_F(AtomicFileTest, RemainsOfOneTargetAreRemovedWhoeverLeftThem) {
  const auto own = folder_ / (".a.txt." + std::to_string(::getpid()) + ".0.tmp");
  const auto kept = {folder_ / "a.txt",          folder_ / ".b.txt.1.0.tmp", folder_ / "a.txt.1.0.tmp",
                     folder_ / ".a.txt.x.0.tmp", folder_ / ".a.txt.1.x.tmp", folder_ / ".a.txt.1.0.bak"};
  write_text(own, "half");
  for (const auto& path : kept) write_text(path, "whole");

  remove_remains(folder_ / "a.txt");

  EXPECT_FALSE(fs::exists(own));
  for (const auto& path : kept) EXPECT_TRUE(fs::exists(path)) << path;
}

TEST_F(AtomicFileTest, ReadingADirectoryIsAnInputError) {
  EXPECT_THROW((void)read_text(folder_), InputError);
}

TEST_F(AtomicFileTest, SecondLockIsRefusedUntilTheFirstEnds) {
  {
    const FileLock lock(folder_ / "lock");
    EXPECT_THROW(FileLock(folder_ / "lock"), UsageError);
  }
  EXPECT_NO_THROW(FileLock(folder_ / "lock"));
}

}  // namespace
}  // namespace elrom::base
