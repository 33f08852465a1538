#include "elrom/particle/collision_job.hpp"

#include <gmock/gmock.h>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::particle {
namespace {

namespace fs = std::filesystem;

/// Three blocks, the last one smaller.
CollisionJob small_job() {
  return {.protocol = {.speed = {0, 5}},
          .law = {.friction = 0.2, .stiffness = 1e5},
          .seed = 4,
          .n_pairs = 20'000,
          .options = {.steps_per_contact = 10, .n_threads = 2}};
}

/// Asks for a stop once so many pairs are done.
class StoppingLog final : public Log {
 public:
  explicit StoppingLog(std::int64_t at) : at_(at) {}
  void message(Level, std::string_view) override {}
  void progress(const Progress& progress) override {
    last_ = progress;
    if (progress.done >= at_) source_.request_stop();
  }
  [[nodiscard]] std::stop_token token() const { return source_.get_token(); }
  Progress last_;

 private:
  std::int64_t at_;
  std::stop_source source_;
};

class CollisionJobTest : public ::testing::Test {
 protected:
  const test::TemporaryFolder folder_;
  const fs::path path_ = folder_ / "collisions.h5";
  const fs::path blocks_ = folder_ / ".collisions.h5.blocks";

  [[nodiscard]] CollisionRun make(const CollisionJob& job) const {
    return make_collision_file(path_, job, {{"made by", "a test"}}, silent_log(), {});
  }
};

TEST_F(CollisionJobTest, TheFileHoldsWhatIsMadeInOnePiece) {
  const auto job = small_job();
  const auto run = make(job);
  EXPECT_EQ(run.n_reused, 0u);
  EXPECT_GT(run.seconds, 0);
  auto whole = make_collisions(job.protocol, job.law, job.seed, 0, job.n_pairs, job.options);
  whole.provenance = {{"made by", "a test"}};
  write_collisions(folder_ / "whole.h5", whole);
  EXPECT_TRUE(test::read_bytes(path_) == test::read_bytes(folder_ / "whole.h5"));
  EXPECT_FALSE(fs::exists(blocks_));
}

TEST_F(CollisionJobTest, AStoppedJobGoesOnToTheSameBytes) {
  static_cast<void>(make(small_job()));
  const auto wanted = test::read_bytes(path_);
  fs::remove(path_);
  StoppingLog log(8192);
  EXPECT_ERROR(Interrupted, "goes on from here",
               make_collision_file(path_, small_job(), {{"made by", "a test"}}, log, log.token()));
  EXPECT_FALSE(fs::exists(path_));
  EXPECT_EQ(log.last_.done, 8192);
  // What a writer that was killed leaves is cleared away.
  test::write_bytes(folder_ / ".collisions.h5.77.0.tmp", "half");

  auto job = small_job();
  job.options.n_threads = 1;
  EXPECT_EQ(make(job).n_reused, 8192u);
  EXPECT_TRUE(test::read_bytes(path_) == wanted);
  EXPECT_FALSE(fs::exists(folder_ / ".collisions.h5.77.0.tmp"));
}

TEST_F(CollisionJobTest, BlocksOfAnotherJobAreNotTaken) {
  const auto keep_first_block = [&](const CollisionJob& job) {
    StoppingLog log(8192);
    EXPECT_THROW(static_cast<void>(make_collision_file(path_, job, {}, log, log.token())), Interrupted);
  };
  const auto reused = [&](void (*change)(CollisionJob&)) {
    keep_first_block(small_job());
    auto job = small_job();
    change(job);
    return make(job).n_reused;
  };
  EXPECT_EQ(reused([](CollisionJob&) {}), 8192u);
  EXPECT_EQ(reused([](CollisionJob& job) { job.n_pairs = 30'000; }), 8192u);
  EXPECT_EQ(reused([](CollisionJob& job) { job.seed = 5; }), 0u);
  EXPECT_EQ(reused([](CollisionJob& job) { job.protocol.speed.high = 6; }), 0u);
  EXPECT_EQ(reused([](CollisionJob& job) { job.law.friction = 0.3; }), 0u);
  EXPECT_EQ(reused([](CollisionJob& job) { job.law.tangential_restitution = 0.9; }), 0u);
  EXPECT_EQ(reused([](CollisionJob& job) { job.speed_cap = 100; }), 0u);
  EXPECT_EQ(reused([](CollisionJob& job) { job.options.steps_per_contact = 11; }), 0u);
  EXPECT_EQ(reused([](CollisionJob& job) { job.options.most_steps = 1000; }), 0u);
}

TEST_F(CollisionJobTest, ADamagedBlockIsMadeAgain) {
  static_cast<void>(make(small_job()));
  const auto wanted = test::read_bytes(path_);
  StoppingLog log(8192);
  EXPECT_THROW(
      static_cast<void>(make_collision_file(path_, small_job(), {{"made by", "a test"}}, log, log.token())),
      Interrupted);
  const auto block = fs::directory_iterator(blocks_)->path();
  auto bytes = test::read_bytes(block);
  bytes[bytes.size() / 2] ^= 1;
  test::write_bytes(block, bytes);
  EXPECT_EQ(make(small_job()).n_reused, 0u);
  EXPECT_TRUE(test::read_bytes(path_) == wanted);
}

TEST_F(CollisionJobTest, TwoOnOneFileAreRefused) {
  const base::FileLock lock(base::lock_beside(path_));
  EXPECT_ERROR(UsageError, "another process", make(small_job()));
}

TEST_F(CollisionJobTest, NonsenseIsRefusedBeforeAnythingIsDone) {
  const auto refused = [&](void (*change)(CollisionJob&)) -> std::string {
    auto job = small_job();
    change(job);
    try {
      static_cast<void>(make(job));
    } catch (const UsageError& error) {
      EXPECT_TRUE(fs::is_empty(folder_.path())) << error.what();
      return error.what();
    }
    return "nothing";
  };
  using testing::HasSubstr;
  EXPECT_THAT(refused([](CollisionJob& job) { job.n_pairs = 0; }), HasSubstr("number of pairs"));
  EXPECT_THAT(refused([](CollisionJob& job) { job.law.restitution = -0.1; }), HasSubstr("restitution"));
  EXPECT_THAT(refused([](CollisionJob& job) { job.protocol.speed = {0, 0}; }), HasSubstr("never meet"));
  EXPECT_THAT(refused([](CollisionJob& job) { job.speed_cap = -1; }), HasSubstr("speed cap"));
  EXPECT_THAT(refused([](CollisionJob& job) { job.speed_cap = NAN; }), HasSubstr("speed cap"));
  EXPECT_THAT(refused([](CollisionJob& job) {
                job.protocol.diameter_2 = {1e100, 1e140};
              }),
              HasSubstr("no finite mass"));
  EXPECT_THAT(refused([](CollisionJob& job) { job.protocol.density_1 = 1e-310; }),
              HasSubstr("no finite mass"));
}

}  // namespace
}  // namespace elrom::particle
