// The program as a script meets it: exit statuses and single lines of error.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "study_fixture.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::study {
namespace {

class ElromTrain : public ::testing::Test {
 protected:
  int run(const std::string& arguments) {
    const auto command = std::string(ELROM_BIN_DIR "/elrom-train ") + arguments + " > " +
                         (folder.path() / "out").string() + " 2> " + (folder.path() / "err").string();
    const int status = std::system(command.c_str());
    out = test::read_bytes(folder.path() / "out");
    error = test::read_bytes(folder.path() / "err");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::string study() const { return (folder.path() / "study").string(); }
  [[nodiscard]] std::string store() const { return (folder.path() / "snapshots.h5").string(); }

  test::TemporaryFolder folder;
  std::string out, error;
};

TEST_F(ElromTrain, HelpListsEverySetting) {
  EXPECT_EQ(run("run --help"), 0);
  EXPECT_THAT(out, ::testing::HasSubstr("screen.builds"));
}

TEST_F(ElromTrain, UsageErrorsEndWithTwo) {
  EXPECT_EQ(run(""), 2);
  EXPECT_EQ(run("run"), 2);
  EXPECT_EQ(run("run " + study() + " --set screen.build=3"), 2);
  EXPECT_THAT(error, ::testing::HasSubstr("screen.builds"));
}

TEST_F(ElromTrain, MissingStoreEndsWithThree) {
  EXPECT_EQ(run("run " + study() + " --store nowhere.h5"), 3);
  EXPECT_EQ(std::ranges::count(error, '\n'), 1) << error;
}

TEST_F(ElromTrain, AnyNumberOfThreadsGivesTheSameBytes) {
  write_small_store(store(), 15);
  const auto train = [&](const std::string& threads) {
    const auto place = study() + threads;
    EXPECT_EQ(run("run " + place + " --store " + store() + " -q --effort quick --threads " + threads), 0)
        << error;
    return test::read_bytes(place + "/model.elrom") + test::read_bytes(place + "/peers/networks.elrom");
  };
  const auto one = train("1");
  EXPECT_FALSE(one.empty());
  EXPECT_EQ(train("2"), one);
  EXPECT_EQ(train("4"), one);
}

TEST_F(ElromTrain, RunThenStatusThenRetrain) {
  write_small_store(store(), 15);
  const auto arguments = study() + " --store " + store() +
                         " -q --effort quick --set method=linear --set peers.networks=false " +
                         "--set 'peers.methods=[\"nearest\"]'";
  ASSERT_EQ(run("run " + arguments), 0) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("pressure"));
  EXPECT_EQ(run("status " + study()), 0) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("model.elrom: linear, 2 fields, 12 cases"));
  write_small_store(store(), 5, 15);

  const auto again = study() + arguments.substr(arguments.find(" -q"));
  ASSERT_EQ(run("retrain " + again + " --json " + (folder.path() / "retrain.json").string()), 0) << error;

  const auto json = test::read_bytes(folder.path() / "retrain.json");
  for (const auto* key : {"seconds", "seconds_from_nothing", "error_before", "error_after", "promoted"}) {
    EXPECT_THAT(json, ::testing::HasSubstr(key));
  }
}

/// What a script meets between a good model and a bad one.
class TrainedStudy : public ElromTrain {
 protected:
  TrainedStudy() {
    write_small_store(store(), 15);
    EXPECT_EQ(run("run " + study() + " --store " + store() + with("linear")), 0) << error;
  }
  static std::string with(const std::string& method) {
    return " -q --effort quick --set method=" + method +
           " --set peers.networks=false --set 'peers.methods=[]'";
  }
  [[nodiscard]] std::string model() const { return test::read_bytes(study() + "/model.elrom"); }
};

TEST_F(TrainedStudy, ARefusedModelEndsWithSevenAndDoesNotAnswer) {
  const auto before = model();
  write_small_store(store(), 5, 15);

  EXPECT_EQ(run("retrain " + study() + with("nearest")), 7) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("not promoted: version 2"));
  EXPECT_EQ(run("run " + study() + with("nearest")), 7) << error;
  EXPECT_EQ(run("fit " + study() + with("nearest")), 7) << error;
  EXPECT_EQ(run("retrain " + study() + with("nearest")), 7) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("nothing was trained: version 2 is of these 16 cases"));
  EXPECT_EQ(model(), before);
  EXPECT_EQ(run("log " + study()), 0);
  EXPECT_EQ(std::ranges::count(out, '\n'), 4)
      << "three versions (a run does not begin at the present one), a line each, and which one answers: "
      << out;
}

TEST_F(TrainedStudy, ALogThatIsBrokenOrLostIsOneLineAndLosesNothing) {
  const auto before = model();
  test::write_bytes(study() + "/models/log.json", "{");
  for (const std::string command : {"log ", "retrain ", "rollback "}) {
    EXPECT_EQ(run(command + study() + (command == "retrain " ? with("linear") : "")), 3);
    EXPECT_EQ(std::ranges::count(error, '\n'), 1) << error;
    EXPECT_THAT(error, ::testing::HasSubstr("put it aside"));
  }
  std::filesystem::remove(study() + "/models/log.json");
  EXPECT_EQ(run("log " + study()), 0);
  EXPECT_THAT(out, ::testing::HasSubstr("log.json is missing"));
  EXPECT_EQ(run("retrain " + study() + with("linear")), 8) << error;
  EXPECT_THAT(error, ::testing::HasSubstr("log.json is missing"));
  EXPECT_EQ(run("log " + study()), 0);
  EXPECT_THAT(out, ::testing::HasSubstr("1  taken in"));
  EXPECT_EQ(model(), before);
}

TEST_F(ElromTrain, ABudgetWarnsOnce) {
  auto furnace = small_furnace();
  furnace.held_out.emplace_back("spare_*");
  write_small_store(store(), 15, 0, furnace);

  ASSERT_EQ(run("run " + study() + " --store " + store() + " -q --set peers.networks=false --budget 30s"), 0)
      << error;

  const std::string warning = "no case matches 'spare_*'";
  const auto first = error.find(warning);
  ASSERT_NE(first, std::string::npos) << error;
  EXPECT_EQ(error.find(warning, first + 1), std::string::npos) << error;
}

TEST_F(TrainedStudy, NothingNewEndsWithEight) {
  EXPECT_EQ(run("retrain " + study() + with("linear")), 8) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("nothing new"));
  EXPECT_EQ(run("run " + study() + with("linear")), 0) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("version 1 answers already"));
}

TEST_F(TrainedStudy, ARefusedModelIsPromotedByHandAndRolledBack) {
  const auto first = model();
  write_small_store(store(), 5, 15);
  ASSERT_EQ(run("retrain " + study() + with("nearest")), 7) << error;

  EXPECT_EQ(run("promote " + study() + " 2 --date 2026-11-24"), 0) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("against the gate"));
  EXPECT_NE(model(), first);
  EXPECT_EQ(run("log " + study()), 0) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("version 2 answers"));
  EXPECT_THAT(out, ::testing::HasSubstr("2026-11-24"));
  EXPECT_EQ(run("rollback " + study()), 0) << error;
  EXPECT_EQ(model(), first);
  EXPECT_EQ(run("rollback " + study()), 2) << "there is none before the first";
  EXPECT_EQ(run("promote " + study() + " 9"), 2);
  EXPECT_THAT(error, ::testing::HasSubstr("known are: 1, 2"));
}

TEST_F(TrainedStudy, DiffTellsCasesSettingsAndErrors) {
  write_small_store(store(), 5, 15);
  (void)run("retrain " + study() + with("nearest"));

  EXPECT_EQ(run("diff " + study() + " 1 2"), 0) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("4 cases added: train_15, train_16, train_17, train_18"));
  EXPECT_THAT(out, ::testing::HasSubstr("method = \"linear\" -> \"nearest\""));
  EXPECT_THAT(out, ::testing::HasSubstr("linear -> nearest"));
}

TEST_F(TrainedStudy, AStoreThatHasMovedIsAskedFor) {
  std::filesystem::rename(store(), store() + ".moved");

  EXPECT_EQ(run("retrain " + study() + with("linear")), 3);
  EXPECT_THAT(error, ::testing::HasSubstr("--store"));
  EXPECT_EQ(run("status " + study()), 0) << error;
  EXPECT_THAT(out, ::testing::HasSubstr("not there any more"));
  EXPECT_EQ(run("retrain " + study() + " --store " + store() + ".moved" + with("linear")), 8) << error;
}

}  // namespace
}  // namespace elrom::study
