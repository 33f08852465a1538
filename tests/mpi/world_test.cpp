// elrom-train on several processes, as a user starts it: the same bytes as one process, and what comes of a
// rank that dies.

#include "elrom/mpi/world.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>

#include <chrono>
#include <cstdlib>
#include <thread>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "study/study_fixture.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::mpi {
namespace {

namespace fs = std::filesystem;

class World : public ::testing::Test {
 protected:
  void SetUp() override { study::write_small_store(folder / "snapshots.h5", 15); }

  [[nodiscard]] std::string command(const std::string& study, int n_ranks,
                                    const std::string& more = {}) const {
    const std::string launcher =
        n_ranks > 1 ? ELROM_MPIEXEC " -n " + std::to_string(n_ranks) + " " : std::string();
    return launcher + ELROM_BIN_DIR "/elrom-train run " + (folder / study).string() + " --store " +
           (folder / "snapshots.h5").string() + " -q --effort quick --set method=networks " +
           "--set 'peers.methods=[]' --set screen.builds=2 --set search.confirm=2 " + more + " > " +
           (folder / "out").string() + " 2> " + (folder / "err").string();
  }
  static int run(const std::string& command) {
    const int status = std::system(command.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::string errors() const { return test::read_bytes(folder / "err"); }
  [[nodiscard]] std::string bundle(const std::string& study) const {
    return test::read_bytes(folder / study / "model.elrom");
  }

  test::TemporaryFolder folder;
};

TEST_F(World, AnyNumberOfRanksGivesTheBytesOfOneProcess) {
  ASSERT_EQ(run(command("one", 1)), 0) << errors();
  for (const int n_ranks : {2, 4}) {
    const auto study = "ranks_" + std::to_string(n_ranks);
    ASSERT_EQ(run(command(study, n_ranks)), 0) << errors();
    EXPECT_EQ(bundle(study), bundle("one")) << n_ranks << " ranks";
  }
}

TEST_F(World, AWrongSettingIsToldOnce) {
  EXPECT_EQ(run(command("wrong", 2, "--set screen.build=3")), 2);
  const auto told = errors();
  const auto first = told.find("screen.build");
  ASSERT_NE(first, std::string::npos);
  EXPECT_EQ(told.find("unknown setting", told.find("unknown setting") + 1), std::string::npos) << told;
}

/// tests/mpi/ranks.cpp on two ranks
struct Ranks : World {
  [[nodiscard]] int run_ranks(const std::string& what) const {
    return run("timeout 60 " ELROM_MPIEXEC " -n 2 " ELROM_RANKS " " + what + " > " +
               (folder / "out").string() + " 2> " + (folder / "err").string());
  }
};

TEST_F(Ranks, ARankIsFreeAgainAfterItsMonitorFailed) {
  ASSERT_EQ(run_ranks("monitor"), 0) << errors();
  EXPECT_EQ(test::read_bytes(folder / "out"), "caught disk full\nthen 10 epochs\n");
}

TEST_F(Ranks, ARankWithoutMemoryEndsTheJobInsteadOfHanging) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need more address space than any limit leaves";
#endif
  EXPECT_EQ(run_ranks("memory"), 1);
  EXPECT_THAT(errors(), ::testing::HasSubstr("error: rank 1: a message from rank 0 broke off"));
}

constexpr int launcher = -1;

/// The process of this rank, or the launcher, in the job
/// whose command line holds `mark`; 0 when there is none.
pid_t process_of_rank(int rank, const std::string& mark) {
  for (const auto& entry : fs::directory_iterator("/proc")) {
    const auto name = entry.path().filename().string();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const auto command = test::read_bytes(entry.path() / "cmdline");
    const auto environment = test::read_bytes(entry.path() / "environ");
    const auto rank_is =
        environment.find("OMPI_COMM_WORLD_RANK=" + (rank == launcher ? "" : std::to_string(rank)));
    const auto program = fs::path(command.substr(0, command.find('\0'))).filename();
    // The launcher is what is neither a rank nor the shell before
    // it; it may go by another name than it was called.
    const bool is_it =
        rank == launcher ? rank_is == std::string::npos && program != "sh" : rank_is != std::string::npos;
    if (is_it && command.find(mark) != std::string::npos && command.find("elrom-train") != std::string::npos)
      return std::stoi(name);
  }
  return 0;
}

/// A job of two ranks that is hit by a signal when some builds are done, and so others are not.
class HitJob : public World {
 protected:
  static constexpr const char* longer = "--set fit.max_epochs=600 --set fit.patience=600";

  void SetUp() override {
    World::SetUp();
    ASSERT_EQ(run(command("whole", 1, longer)), 0) << errors();
  }

  /// @return the job's exit status
  int hit(int rank, int signal) {
    int status = 0;
    std::jthread job([&] { status = run(command("hit", 2, longer)); });
    const auto begin = std::chrono::steady_clock::now();
    while (!some_built() && std::chrono::steady_clock::now() - begin < std::chrono::seconds(60))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const auto victim = process_of_rank(rank, (folder / "hit").string());
    EXPECT_NE(victim, 0) << errors();
    if (victim != 0) ::kill(victim, signal);
    job.join();
    // A launcher may end before what it launched, and a rank that ends keeps its files when its
    // environment is gone: the study is free when its lock is.
    const auto works = [&](int one) { return process_of_rank(one, (folder / "hit").string()) != 0; };
    while (works(0) || works(1) || is_locked(folder / "hit" / ".lock"))
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return status;
  }

  void expect_that_the_study_goes_on() {
    EXPECT_FALSE(fs::exists(folder / "hit" / "model.elrom"));
    ASSERT_EQ(run(command("hit", 1, longer)), 0) << errors();
    EXPECT_EQ(bundle("hit"), bundle("whole"));
  }

 private:
  static bool is_locked(const fs::path& lock) try {
    [[maybe_unused]] const base::FileLock held(lock);
    return false;
  } catch (const UsageError&) {
    return true;
  }
  [[nodiscard]] bool some_built() const {
    const auto stages = folder / "hit" / "stages";
    if (!fs::exists(stages)) return false;
    return std::ranges::any_of(fs::directory_iterator(stages), [](const fs::directory_entry& entry) {
      return entry.path().filename().string().starts_with("build-");
    });
  }
};

TEST_F(HitJob, ARankThatDiesEndsInAnErrorAndAStudyThatGoesOn) {
  EXPECT_NE(hit(1, SIGKILL), 0);
  EXPECT_THAT(errors(), ::testing::HasSubstr("rank 1"));
  expect_that_the_study_goes_on();
}

TEST_F(HitJob, CtrlCAtTheLauncherLeavesAStudyThatGoesOn) {
  EXPECT_NE(hit(launcher, SIGINT), 0);
  expect_that_the_study_goes_on();
}

TEST_F(HitJob, AStopReachesEveryRank) {
  EXPECT_EQ(hit(0, SIGTERM), 130);
  EXPECT_THAT(errors(), ::testing::HasSubstr("stopped on request"));
  expect_that_the_study_goes_on();
}

}  // namespace
}  // namespace elrom::mpi
