// The program as a script meets it: files, exit statuses, single lines of error, kill -9.
#include "spheres_for_tests.hpp"
#include "support/outcome.hpp"

namespace elrom::scene {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class ElromSimulate : public testing::Test {
 protected:
  void SetUp() override { folder.write("scene.toml", text); }
  [[nodiscard]] elrom::test::Outcome simulate(const std::string& arguments,
                                              const std::string& before = "") const {
    return elrom::test::outcome_of(before + ELROM_BIN_DIR "/elrom-simulate " +
                                   (folder / "scene.toml").string() + " --threads 1 " + arguments + " 2>&1");
  }
  [[nodiscard]] std::string out(const std::string& name) const {
    return " --output " + (folder / name).string();
  }

  const std::string text =
      "[scene]\nname = \"small\"\nduration = \"40 ms\"\ntime_step = \"0.1 ms\"\n"
      "[effects]\ngravity = [0, 0, -9.81]\ncollisions = \"helscm\"\n[output]\nevery = \"10 ms\"\ncheckpoint_every = \"1 ms\"\n"
      "[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [\"20 mm\", \"20 mm\", \"20 mm\"]\n"
      "[[particles]]\ngroup = \"a\"\ndiameter = \"500 um\"\nnumber = 500\nscatter = \"1 m/s\"\n";
  elrom::test::TemporaryFolder folder;
};

TEST_F(ElromSimulate, WritesWhatItSaysAndExplainsItsEffects) {
  const auto told = simulate("--explain --json " + (folder / "j").string() + out("o"));
  EXPECT_EQ(told.status, 0) << told.text;
  EXPECT_THAT(told.text, AllOf(HasSubstr("estimated"), HasSubstr("Measured"), HasSubstr("gravity"),
                               HasSubstr("500 spheres")));
  EXPECT_THAT(test::read_bytes(folder / "j"),
              AllOf(HasSubstr("\"elrom-scene\""), HasSubstr("\"seconds_estimated\"")));
  EXPECT_THAT(test::read_bytes(folder / "o" / "particles.pvd"), HasSubstr("particles_000000000400.vtp"));
  EXPECT_THAT(test::read_bytes(folder / "o" / "series.csv"), HasSubstr("collisions of a and a"));
}

// A box whose top is open, thrown through: spheres leave, and more come.
TEST_F(ElromSimulate, ResidenceTimesAndWallHitsAreByGroupAndGoOnAfterAStop) {
  const std::string open = " --set 'domain.outlets=[\"box.z_high\"]' --set 'effects.gravity=[0,0,0]'";
  ASSERT_EQ(simulate(open + out("whole")).status, 0);
  ASSERT_EQ(simulate(open + " --set scene.duration=0.02" + out("parts")).status, 0);
  const auto told = simulate(open + out("parts"));
  ASSERT_EQ(told.status, 0);
  EXPECT_THAT(told.text, AllOf(HasSubstr("a: "), HasSubstr("left after"), HasSubstr("wall hits")));
  for (const auto* name : {"residence.csv", "checkpoint.elrom"})
    EXPECT_EQ(test::read_bytes(folder / "whole" / name), test::read_bytes(folder / "parts" / name)) << name;
  const auto times = test::read_bytes(folder / "whole" / "residence.csv");
  EXPECT_THAT(times, HasSubstr("group,from [s],to [s],number\na,"));
  EXPECT_EQ(times.find(",0\n"), std::string::npos) << "only times that were";
  EXPECT_THAT(test::read_bytes(folder / "whole" / "summary.json"), HasSubstr("\"mean_residence_s\""));
}

TEST_F(ElromSimulate, SummaryOfAWholeRunStaysWhenItIsAskedForAgain) {
  ASSERT_EQ(simulate(out("o")).status, 0);
  const auto before = test::read_bytes(folder / "o" / "summary.json");
  ASSERT_EQ(simulate(out("o")).status, 0);
  EXPECT_EQ(test::read_bytes(folder / "o" / "summary.json"), before);
  EXPECT_THAT(before, HasSubstr("\"resumed_from\": 0"));
}

TEST_F(ElromSimulate, KilledRunGoesOnToTheSameBytes) {
  ASSERT_EQ(simulate(out("whole")).status, 0);
  for (const auto* seconds : {"0.05", "0.15", "0.3"})
    static_cast<void>(simulate(out("killed"), std::string("timeout -s KILL ") + seconds + " "));
  ASSERT_EQ(simulate(out("killed")).status, 0);
  for (const auto* name : {"checkpoint.elrom", "series.csv", "particles.pvd", "particles_000000000400.vtp"})
    EXPECT_EQ(test::read_bytes(folder / "whole" / name), test::read_bytes(folder / "killed" / name)) << name;
}

TEST_F(ElromSimulate, MistakesEndInOneLineAndTheirStatus) {
  const auto expect = [&](const std::string& arguments, int status, const std::string& said) {
    const auto told = simulate(arguments);
    EXPECT_EQ(told.status, status) << told.text;
    EXPECT_THAT(told.text, HasSubstr(said));
    EXPECT_EQ(std::ranges::count(told.text, '\n'), 1) << told.text;
  };
  expect("--set effects.collision=dem" + out("o"), 2, "did you mean 'effects.collisions'");
  expect("--set effects.collisions=helscn" + out("o"), 2, "did you mean 'helscm'");
  expect("--set scene.time_step=0" + out("o"), 2, "scene.time_step");
  expect("--set collisions.model=none.elrom" + out("o"), 3, "none.elrom");
  ASSERT_EQ(simulate("--small" + out("o")).status, 0);
  expect("--set scene.seed=2" + out("o"), 3, "another scene");
  test::write_bytes(folder / "o" / "checkpoint.elrom", "no checkpoint");
  expect(out("o"), 3, "checkpoint.elrom");
}

}  // namespace
}  // namespace elrom::scene
