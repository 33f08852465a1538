#include "elrom/ingest/watch.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"
#include "support/recording_log.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::ingest {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

namespace fs = std::filesystem;

class Watching : public ::testing::Test {
 protected:
  Watching() {
    fs::create_directory(folder_ / "in");
    field::write_mesh(folder_ / "mesh.h5", field::make_furnace_mesh({}, 5, 6, 10));
    options_.folder = folder_ / "in";
    options_.import.mesh = folder_ / "mesh.h5";
    options_.import.store = folder_ / "store.h5";
  }
  void deliver(const std::string& name) const {
    fs::copy_file(ELROM_SOURCE_DIR "/data/cases/" + name + ".h5", options_.folder / (name + ".h5"));
  }
  void deliver_damaged(const std::string& name) const {
    const auto bytes = test::read_bytes(ELROM_SOURCE_DIR "/data/cases/" + name + ".h5");
    test::write_bytes(options_.folder / (name + ".h5"), bytes.substr(0, bytes.size() / 2));
  }
  [[nodiscard]] std::size_t n_in_store() const {
    return field::SnapshotStore::open(options_.import.store).n_cases();
  }

  test::TemporaryFolder folder_;
  WatchOptions options_;
  test::RecordingLog log_;
};

TEST_F(Watching, ImportsWhatTwoLooksFindUnchanged) {
  Watcher watcher(options_);
  deliver("train_000");

  const auto first = watcher.look(log_);
  EXPECT_THAT(first.added, IsEmpty());
  EXPECT_EQ(first.n_unfinished, 1U);
  deliver("train_001");  // comes while we watch
  EXPECT_THAT(watcher.look(log_).added, ElementsAre("train_000"));
  EXPECT_THAT(watcher.look(log_).added, ElementsAre("train_001"));
  EXPECT_THAT(watcher.look(log_).added, IsEmpty());
  EXPECT_EQ(n_in_store(), 2U);
  EXPECT_TRUE(fs::exists(options_.folder / "train_000.h5"));
}

TEST_F(Watching, AFileThatGrowsIsLeftAlone) {
  Watcher watcher(options_);
  const auto file = options_.folder / "train_000.h5";
  const auto bytes = test::read_bytes(ELROM_SOURCE_DIR "/data/cases/train_000.h5");
  for (const std::size_t part : {4U, 3U, 2U}) {
    test::write_bytes(file, bytes.substr(0, bytes.size() / part));
    const auto look = watcher.look(log_);
    EXPECT_THAT(look.refused, IsEmpty());
    EXPECT_EQ(look.n_unfinished, 1U);
  }
  test::write_bytes(file, bytes);
  (void)watcher.look(log_);

  EXPECT_THAT(watcher.look(log_).added, ElementsAre("train_000"));
}

TEST_F(Watching, OneBadFileDoesNotKeepTheOthersOut) {
  Watcher watcher(options_);
  deliver("train_000");
  deliver_damaged("train_001");
  deliver("train_002");
  (void)watcher.look(log_);

  const auto look = watcher.look(log_);

  EXPECT_THAT(look.added, ElementsAre("train_000", "train_002"));
  ASSERT_EQ(look.refused.size(), 1U);
  EXPECT_FALSE(fs::exists(options_.folder / "train_001.h5"));
  EXPECT_TRUE(fs::exists(options_.folder / "refused" / "train_001.h5"));
  EXPECT_EQ(test::read_bytes(options_.folder / "refused" / "train_001.h5.reason.txt"),
            look.refused[0].reason + "\n");
  EXPECT_THAT(watcher.look(log_).refused, IsEmpty());
}

TEST_F(Watching, ASecondRefusalOfTheSameNameKeepsTheFirst) {
  Watcher watcher(options_);
  for (int i = 0; i < 2; ++i) {
    deliver_damaged("train_001");
    (void)watcher.look(log_);
    (void)watcher.look(log_);
  }

  EXPECT_TRUE(fs::exists(options_.folder / "refused" / "train_001.h5"));
  EXPECT_TRUE(fs::exists(options_.folder / "refused" / "train_001-2.h5"));
  EXPECT_TRUE(fs::exists(options_.folder / "refused" / "train_001-2.h5.reason.txt"));
}

TEST_F(Watching, AnotherWatchKnowsWhatTheStoreHolds) {
  for (int i = 0; i < 2; ++i) {
    if (i == 0) deliver("train_000");
    Watcher watcher(options_);
    (void)watcher.look(log_);
    EXPECT_EQ(watcher.look(log_).added.size(), i == 0 ? 1U : 0U);
  }
  EXPECT_EQ(n_in_store(), 1U);
}

TEST_F(Watching, TheSameCaseUnderAnotherNameIsRefusedWithTheReason) {
  Watcher watcher(options_);
  deliver("train_000");
  (void)watcher.look(log_);
  (void)watcher.look(log_);
  deliver("train_001");
  fs::rename(options_.folder / "train_001.h5", options_.folder / "train_000b.h5");
  fs::copy_file(options_.folder / "train_000b.h5", options_.folder / "train_000c.h5");
  (void)watcher.look(log_);

  const auto look = watcher.look(log_);

  EXPECT_THAT(look.added, ElementsAre("train_001"));
  ASSERT_EQ(look.refused.size(), 1U);
  EXPECT_THAT(look.refused[0].reason, HasSubstr("already in the store"));
}

TEST_F(Watching, OtherFilesAreNotTouched) {
  Watcher watcher(options_);
  deliver("train_000");
  fs::copy_file(ELROM_SOURCE_DIR "/data/cases/cases.csv", options_.folder / "cases.csv");
  test::write_bytes(options_.folder / "remarks", "x");
  test::write_bytes(options_.folder / "README.txt",
                    "Exports of the furnace, as they come.\n\nx and y in m.\n");
  test::write_bytes(options_.folder / "solver.dat", "iteration residual\n1 0.5\n");
  test::write_bytes(options_.folder / ".train_003.h5.part", "x");
  (void)watcher.look(log_);

  const auto look = watcher.look(log_);

  EXPECT_THAT(look.refused, IsEmpty());
  EXPECT_THAT(look.added, ElementsAre("train_000"));
  for (const auto* name : {"cases.csv", "remarks", "README.txt", "solver.dat"})
    EXPECT_TRUE(fs::exists(options_.folder / name)) << name;
}

TEST_F(Watching, WhatIsNoExportIsNamedOnceAndATableThatIsOneIsRefused) {
  Watcher watcher(options_);
  test::write_bytes(options_.folder / "remarks", "x");
  test::write_bytes(options_.folder / "README.txt", "Exports of the furnace, as they come.\n");
  test::write_bytes(options_.folder / "broken.txt", "x-coordinate, y-coordinate, pressure\n1, 2\n");
  const auto first = watcher.look(log_), second = watcher.look(log_), third = watcher.look(log_);

  EXPECT_THAT(first.left_alone, ElementsAre(options_.folder / "remarks"));
  EXPECT_THAT(second.left_alone, ElementsAre(options_.folder / "README.txt"));
  EXPECT_THAT(third.left_alone, IsEmpty());
  ASSERT_EQ(second.refused.size(), 1U);
  EXPECT_THAT(second.refused[0].reason, HasSubstr("missing column 'z-coordinate'"));
}

TEST_F(Watching, ANewStoreNeedsAMeshAndAFolder) {
  options_.import.mesh.clear();
  EXPECT_ERROR(UsageError, "needs a reduced mesh", Watcher(options_));
  options_.folder = folder_ / "nowhere";
  EXPECT_ERROR(InputError, "no folder to watch", Watcher(options_));
}

}  // namespace
}  // namespace elrom::ingest
