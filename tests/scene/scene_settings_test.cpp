#include "elrom/scene/scene_settings.hpp"

#include "elrom/base/error.hpp"
#include "spheres_for_tests.hpp"
#include "support/throws.hpp"

namespace elrom::scene {
namespace {

const std::string small_scene = R"(
[scene]
duration = "10 ms"
time_step = "0.1 ms"
[[domain.boxes]]
name = "box"
low = [0, 0, 0]
high = ["20 mm", 0.02, "2 cm"]
[[particles]]
group = "a"
diameter = "315 um"
number = 10
)";

std::string with(const std::string& more) { return more + small_scene; }

TEST(SceneSettings, UnitsAreTakenAnywhere) {
  const auto s = parse_scene(small_scene, "s.toml");
  EXPECT_DOUBLE_EQ(s.duration, 0.01);
  EXPECT_DOUBLE_EQ(s.groups[0].diameter, 315e-6);
  EXPECT_DOUBLE_EQ(s.boxes[0].high.z, 0.02);
  EXPECT_EQ(s.n_steps(), 100);
}

TEST(SceneSettings, TopOfABoxTakesUnitsAndReadsBack) {
  auto text = small_scene;
  text.replace(text.find("[[particles]]"), 0,
               "top_low = [\"1 mm\", 0.002]\ntop_high = [\"1.5 cm\", \"15 mm\"]\n");
  const auto s = parse_scene(text, "s.toml");
  EXPECT_DOUBLE_EQ(s.boxes[0].top_low[0], 0.001);
  EXPECT_DOUBLE_EQ(s.boxes[0].top_low[1], 0.002);
  EXPECT_DOUBLE_EQ(s.boxes[0].top_high[0], 0.015);
  EXPECT_EQ(to_toml(parse_scene(to_toml(s), "again.toml")), to_toml(s));
  text.replace(text.find("0.002]"), 6, "\"2 kg\"]");
  EXPECT_ERROR(UsageError, "top_low", parse_scene(text, "s.toml"));
}

TEST(SceneSettings, WrittenSceneReadsBackToItself) {
  const auto text =
      to_toml(parse_scene(with("[effects]\ncollisions = \"dem\"\ngravity = [0, 0, -9.81]\n"), "s.toml"));
  EXPECT_EQ(to_toml(parse_scene(text, "again.toml")), text);
}

TEST(SceneSettings, CommandLineWins) {
  const auto s = parse_scene(small_scene, "s.toml", {"effects.collisions=dem", "scene.time_step=1e-5"});
  EXPECT_EQ(s.collisions, "dem");
  EXPECT_EQ(s.n_steps(), 1000);
}

TEST(SceneSettings, MistakesAreToldWithLineAndNearestName) {
  EXPECT_ERROR(UsageError, "did you mean 'effects.gravity'",
               parse_scene(with("[effects]\ngravty = [0, 0, 1]\n"), "s.toml"));
  EXPECT_ERROR(UsageError, "s.toml:2", parse_scene(with("[effects]\ncollisions = \"dme\"\n"), "s.toml"));
  EXPECT_ERROR(UsageError, "a number in s or a text with a unit",
               parse_scene(small_scene, "s.toml", {"scene.time_step=\"3 kg\""}));
  EXPECT_ERROR(UsageError, "either number or mass", parse_scene(small_scene + "mass = 1\n", "s.toml"));
  EXPECT_ERROR(UsageError, "missing setting 'particles'",
               parse_scene("[scene]\nduration = 1\ntime_step = 1\n", "s.toml"));
  EXPECT_ERROR(UsageError, "expected effects.rotation = true",
               parse_scene(with("[collisions]\nfriction = 0.3\n"), "s.toml"));
  EXPECT_ERROR(UsageError, "missing setting 'grid.cell'",
               parse_scene(with("[effects]\ncollisions = \"hel\"\n"), "s.toml"));
  EXPECT_ERROR(UsageError, "collision model of single spheres",
               parse_scene(small_scene + "parcels = 8\n", "s.toml", {"effects.collisions=dem"}));
  EXPECT_ERROR(UsageError, "a coupled gas without effects.drag",
               parse_scene(with("[gas]\nmodel = \"coupled\"\n[grid]\ncell = [1, 1, 1]\n"), "s.toml"));
  EXPECT_ERROR(UsageError, "without a gas", parse_scene(with("[effects]\ndrag = \"stokes\"\n"), "s.toml"));
}

TEST(SceneSettings, HostileTextsEndInOneLine) {
  for (const std::string text :
       {"", "[", "\x00\x01", "scene = 3", "[scene]\nduration = nan\ntime_step = 1", "particles = 3",
        "particles = [1, 2]", "domain = { boxes = [[]] }", "[scene]\ntime_step = \"1e999 s\"",
        "[scene]\nduration = -1", "[scene]\nseed = 1e3", "regions = [{name = 3}]"})
    EXPECT_THROW(static_cast<void>(parse_scene(text, "s.toml")), UsageError) << text;
}

}  // namespace
}  // namespace elrom::scene
