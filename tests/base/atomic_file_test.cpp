#include "elrom/base/atomic_file.hpp"

#include <gtest/gtest.h>
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
