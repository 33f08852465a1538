// The subcommand as a script meets it: models, exit statuses, single lines of error.

#include <gmock/gmock.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

#include "elrom/particle/collision_errors.hpp"
#include "elrom/particle/collision_model.hpp"
#include "elrom/particle/collision_set.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::surrogate {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

class ElromTrainCollisions : public testing::Test {
 protected:
  void SetUp() override {
    const particle::ContactLaw law{.friction = 0.3, .stiffness = 1e6};
    particle::write_collisions(folder / "set.h5", make_collisions({.spin_speed = 5}, law, 1, 0, 3000, {}));
  }
  int run(const std::string& arguments, const std::string& set = "set.h5") {
    const auto command = std::string(ELROM_BIN_DIR "/elrom-train collisions ") + (folder / set).string() +
                         " --quiet " + arguments + " --output " + model().string() + " > " +
                         (folder / "out").string() + " 2> " + (folder / "err").string();
    const int status = std::system(command.c_str());
    out = test::read_bytes(folder / "out");
    error = test::read_bytes(folder / "err");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  [[nodiscard]] std::filesystem::path model() const { return folder / "model.elrom"; }
  [[nodiscard]] double mae() const {
    const auto bundle = particle::CollisionBundle::read(model());
    const auto set = particle::read_collisions(folder / "set.h5");
    return errors_of(*bundle.model, set, 2850, 150).mae_velocity;
  }

  test::TemporaryFolder folder;
  std::string out, error;
};

TEST_F(ElromTrainCollisions, LearnsWithEveryRegressorOfThisBuild) {
  ASSERT_EQ(run("--json " + (folder / "j").string()), 0) << error;
  EXPECT_LT(mae(), 0.01);
  EXPECT_THAT(out, HasSubstr("no collision gains energy"));
  EXPECT_THAT(test::read_bytes(folder / "j"), HasSubstr("elrom-collision-training"));
  // 6: a part that this build left out.
  const int network = run("--regressor network");
  EXPECT_THAT(network, AnyOf(0, 6)) << error;
  if (network == 0) {
    EXPECT_LT(mae(), 0.2);
  }
  const int trees = run("--regressor trees --trials 1");
  EXPECT_THAT(trees, AnyOf(0, 6)) << error;
  if (trees == 0) {
    EXPECT_LT(mae(), 0.5);
  }
  const int document = run("--surrogate document --trials 1");
  EXPECT_EQ(document, trees) << error;
}

TEST_F(ElromTrainCollisions, MistakesAreOneLineAndLeaveTheOldModel) {
  ASSERT_EQ(run("--surrogate exact"), 0) << error;
  const auto before = test::read_bytes(model());
  EXPECT_EQ(run("--surrogate frames"), 2);
  EXPECT_THAT(error, HasSubstr("did you mean 'frame'"));
  EXPECT_EQ(run("--regressor tree"), 2);
  EXPECT_EQ(run("", "nowhere.h5"), 3);
  EXPECT_EQ(std::ranges::count(error, '\n'), 1) << error;
  EXPECT_EQ(run("", "model.elrom"), 3);
  EXPECT_EQ(std::ranges::count(error, '\n'), 1) << error;
  EXPECT_EQ(test::read_bytes(model()), before);
}

}  // namespace
}  // namespace elrom::surrogate
