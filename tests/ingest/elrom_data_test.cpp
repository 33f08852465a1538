// The program as a script meets it: what import refuses, removal, and the watched folder.

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <cstdlib>

#include "elrom/field/snapshot_store.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::ingest {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

namespace fs = std::filesystem;

class ElromData : public ::testing::Test {
 protected:
  ElromData() {
    fs::create_directory(folder_ / "in");
    field::write_mesh(folder_ / "mesh.h5", field::make_furnace_mesh({}, 5, 6, 10));
  }
  int run(const std::string& arguments) {
    const auto command = "cd " + folder_.path().string() + " && " ELROM_BIN_DIR "/elrom-data " + arguments +
                         " > out.txt 2> err.txt";
    const int status = std::system(command.c_str());
    out_ = test::read_bytes(folder_ / "out.txt");
    error_ = test::read_bytes(folder_ / "err.txt");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  void deliver(const std::string& name) const {
    fs::copy_file(ELROM_SOURCE_DIR "/data/cases/" + name + ".h5", folder_ / ("in/" + name + ".h5"));
  }
  [[nodiscard]] std::string file(const std::string& name) const { return test::read_bytes(folder_ / name); }

  const std::string mesh_ = " --mesh mesh.h5 --store store.h5 ";
  test::TemporaryFolder folder_;
  std::string out_, error_;
};

TEST_F(ElromData, RemovesCasesByNameAndPattern) {
  for (const auto* name : {"train_000", "train_001", "train_012", "load_064"}) deliver(name);
  ASSERT_EQ(run("import" + mesh_ + "in/*.h5"), 0) << error_;

  EXPECT_EQ(run("remove --store store.h5 'train_00*' train_001"), 0) << error_;

  EXPECT_THAT(out_, AllOf(HasSubstr("removed: train_000, train_001"), HasSubstr("2 cases are left")));
  EXPECT_EQ(field::SnapshotStore::open(folder_ / "store.h5").n_cases(), 2U);
}

TEST_F(ElromData, RemovingCasesThatJudgeIsTold) {
  for (const auto* name : {"train_000", "train_001", "load_064"}) deliver(name);
  fs::copy_file(ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml", folder_ / "mesh.toml");
  ASSERT_EQ(run("import" + mesh_ + "in/*.h5"), 0) << error_;

  EXPECT_EQ(run("remove --store store.h5 load_064 train_001"), 0) << error_;
  EXPECT_THAT(error_, AllOf(HasSubstr("warning: held out so far, to judge models on: load_064;"),
                            HasSubstr("elrom-report accuracy STUDY --cases")));
  deliver("train_002");
  ASSERT_EQ(run("import" + mesh_ + "in/train_002.h5"), 0) << error_;
  EXPECT_EQ(run("remove --store store.h5 train_002"), 0);
  EXPECT_EQ(error_, "");
}

TEST_F(ElromData, ChecksExportsWithoutInputsBesideATableOfThem) {
  deliver("train_001");
  ASSERT_EQ(run("import" + mesh_ + "in/*.h5"), 0) << error_;
  fs::copy_file(ELROM_SOURCE_DIR "/data/formats/fluent_ascii/train_000_comma.txt.gz",
                folder_ / "train_000.txt.gz");
  const std::string cases = " --cases " ELROM_SOURCE_DIR "/data/cases/cases.csv";

  EXPECT_EQ(run("check store.h5 train_000.txt.gz"), 3);
  EXPECT_THAT(out_, HasSubstr("give them in a table by --cases"));
  (void)run("check store.h5 train_000.txt.gz" + cases);
  EXPECT_THAT(out_, AllOf(HasSubstr("2 cases checked"), ::testing::Not(HasSubstr("unreadable"))));
  fs::rename(folder_ / "train_000.txt.gz", folder_ / "trian_000.txt.gz");
  (void)run("check store.h5 trian_000.txt.gz" + cases);
  EXPECT_THAT(out_, HasSubstr("did you mean 'train_000'?"));
}

TEST_F(ElromData, ANameThatMatchesNothingRemovesNothing) {
  for (const auto* name : {"train_000", "train_001"}) deliver(name);
  ASSERT_EQ(run("import" + mesh_ + "in/*.h5"), 0) << error_;
  const auto before = file("store.h5");

  EXPECT_EQ(run("remove --store store.h5 train_000 trian_001"), 3);
  EXPECT_THAT(error_, AllOf(HasSubstr("'trian_001'"), HasSubstr("did you mean 'train_001'?")));
  EXPECT_EQ(run("remove --store store.h5 'train_*'"), 3);
  EXPECT_THAT(error_, HasSubstr("no case would be left"));
  EXPECT_EQ(file("store.h5"), before);
}

TEST_F(ElromData, ChecksThatAreAcceptedAreNamed) {
  deliver("train_000");
  EXPECT_EQ(run("import" + mesh_ + "--accept ruoghness in/*.h5"), 2);
  EXPECT_THAT(error_, HasSubstr("did you mean 'roughness'?"));
  EXPECT_EQ(run("import" + mesh_ + "--accept roughness,outlier in/*.h5"), 0) << error_;
}

TEST_F(ElromData, WatchOnceTellsByItsStatusWhatCame) {
  const auto watch = "watch in --once --every 0.1" + mesh_;
  EXPECT_EQ(run(watch), 8);
  EXPECT_THAT(out_, HasSubstr("nothing new"));
  test::write_bytes(folder_ / "in/bad.h5", "no export");
  EXPECT_EQ(run(watch), 3);
  EXPECT_THAT(out_, HasSubstr("refused: bad.h5: "));
  deliver("train_000");
  EXPECT_EQ(run(watch), 0);
  EXPECT_THAT(out_, HasSubstr("added: train_000; store.h5 now holds 1"));
  EXPECT_EQ(run(watch), 8);
}

TEST_F(ElromData, WatchLeavesNotesAloneAndSaysSo) {
  test::write_bytes(folder_ / "in/README.txt", "Exports of the furnace, as they come.\n");
  EXPECT_EQ(run("watch in --once --every 0.1" + mesh_), 8);
  EXPECT_THAT(out_, AllOf(HasSubstr("left alone, no exports: README.txt\n"), HasSubstr("nothing new")));
  EXPECT_TRUE(fs::exists(folder_ / "in/README.txt"));
}

TEST_F(ElromData, TheCommandIsToldOfEachBatchAndItsFailureStopsNothing) {
  const auto watch =
      "watch in --once --every 0.1" + mesh_ + R"(--then 'echo "$ELROM_STORE $ELROM_ADDED" >> told; exit 5')";
  EXPECT_EQ(run(watch), 8);
  EXPECT_FALSE(fs::exists(folder_ / "told"));
  deliver("train_000");
  deliver("train_001");

  EXPECT_EQ(run(watch), 0);

  EXPECT_THAT(error_, HasSubstr("ended with status 5"));
  EXPECT_EQ(file("told"), (folder_ / "store.h5").string() + " train_000,train_001\n");
}

// The command kills the watch that waits for it: the batch is in the store, and the next watch tells of it.
TEST_F(ElromData, AKilledWatchLosesNothing) {
  deliver("train_000");
  const auto watch = "watch in --once --every 0.1" + mesh_;
  EXPECT_NE(run(watch + "--then 'kill -9 $PPID'"), 0);
  EXPECT_EQ(field::SnapshotStore::open(folder_ / "store.h5").n_cases(), 1U);

  EXPECT_EQ(run(watch + R"(--then 'echo "$ELROM_ADDED" >> told')"), 8);

  EXPECT_EQ(file("told"), "train_000\n");
  EXPECT_EQ(run(watch + R"(--then 'echo "$ELROM_ADDED" >> told')"), 8);
  EXPECT_EQ(file("told"), "train_000\n");
}

// The command that follows the import sends the signal: however slow the machine is, the case is in by then.
TEST_F(ElromData, CtrlCEndsAWatch) {
  deliver("train_000");

  EXPECT_EQ(run("watch in --every 0.2" + mesh_ + "--then 'kill -INT $PPID'"), 130) << error_;

  EXPECT_THAT(error_, HasSubstr("watching ended"));
  EXPECT_THAT(out_, HasSubstr("added: train_000"));
}

}  // namespace
}  // namespace elrom::ingest
