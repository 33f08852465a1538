#include "elrom/field/furnace.hpp"

#include <gmock/gmock.h>

#include "elrom/base/atomic_file.hpp"
#include "elrom/base/error.hpp"
#include "elrom/field/mesh.hpp"
#include "support/temporary_folder.hpp"
#include "support/throws.hpp"

namespace elrom::field {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr const char* shipped_file = ELROM_SOURCE_DIR "/data/mesh/furnace_20x42x66.toml";

const std::string least =
    "name = \"f\"\n[solids]\ndensity_kg_per_m3 = 2500\npacking_limit = 0.6\n"
    "[[opening]]\ninputs = \"air_*\"\nlow_m = 1\nhigh_m = 2.5\n";

InputSchema inputs_of_a_furnace() {
  return InputSchema({{"air_1", "kg/s", "kg/s"},
                      {"air_2", "kg/s", "kg/s"},
                      {"fuel", "kg/s", "kg/s"},
                      {"air_temperature", "K", "K"}});
}

auto refuses(const std::string& text, const std::string& a, const std::string& b) {
  const auto read = [=] { (void)parse_furnace(text, "f.toml"); };
  return ::testing::Matches(ThrowsMessage<InputError>(AllOf(HasSubstr(a), HasSubstr(b))))(read);
}

TEST(Furnace, ReadsWhatTheFileSays) {
  const auto furnace = parse_furnace(least, "f.toml");

  EXPECT_EQ(furnace.name, "f");
  EXPECT_DOUBLE_EQ(furnace.solid_density, 2500);
  EXPECT_DOUBLE_EQ(furnace.packing_limit, 0.6);
  ASSERT_EQ(furnace.openings.size(), 1U);
  EXPECT_EQ(furnace.openings[0].inputs, "air_*");
  EXPECT_EQ(furnace.openings[0].kind, "other");
  EXPECT_DOUBLE_EQ(furnace.openings[0].low_m, 1);
  EXPECT_DOUBLE_EQ(furnace.openings[0].high_m, 2.5);
  EXPECT_TRUE(std::isinf(furnace.outlet_low_m));
  EXPECT_TRUE(furnace.held_out.empty());
}

TEST(Furnace, GivesReportsTheirWordsAndNeutralOnesWhereItNamesNone) {
  const auto described = read_furnace(shipped_file).words, neutral = parse_furnace(least, "f.toml").words;
  const auto one = parse_furnace(least + "[words]\ncase = \"run\"\n", "f.toml").words;

  EXPECT_EQ(described.case_word(1), "load");
  EXPECT_EQ(described.case_word(3), "loads");
  EXPECT_EQ(described.reference(), "EL3D");
  EXPECT_EQ(neutral.case_word(3), "cases");
  EXPECT_EQ(one.case_word(3), "runs");
  EXPECT_EQ(neutral.reference(), "reference");
}

TEST(Furnace, WrittenTextReadsBackToItself) {
  auto furnace = read_furnace(shipped_file);
  furnace.name = "a \"quoted\"\nname \\";

  const auto again = parse_furnace(to_toml(furnace), "text");

  EXPECT_EQ(to_toml(again), to_toml(furnace));
  EXPECT_EQ(again.name, furnace.name);
  EXPECT_EQ(again.openings.size(), 8U);
  EXPECT_DOUBLE_EQ(again.outlet_low_m, furnace.outlet_low_m);
  EXPECT_EQ(again.mirrors.at(1).swap.at(2).second, "return_rear_*");
  EXPECT_EQ(again.mirrors.at(1).axis, 'x');
  EXPECT_EQ(again.words.reference(), "EL3D");
}

// Heights as faces of the CFD mesh, 33 layers of 47 m.
TEST(Furnace, TheShippedOneLiesAsItsPatches) {
  constexpr double layer = 47.0 / 33.0;

  const auto furnace = read_furnace(shipped_file);

  EXPECT_EQ(furnace.outlet_low_m, 29 * layer);
  EXPECT_EQ(furnace.solid_density, 2400);
  EXPECT_EQ(furnace.packing_limit, packing_limit);
  EXPECT_THAT(furnace.held_out, ElementsAre("load_*", "rep*"));
  EXPECT_TRUE(furnace.is_repeat("rep1_064"));
  EXPECT_FALSE(furnace.is_repeat("load_064"));
  std::map<std::string, std::pair<double, double>> heights;
  for (const auto& opening : furnace.openings) heights[opening.inputs] = {opening.low_m, opening.high_m};
  const std::map<std::string, std::pair<double, double>> expected{
      {"primary_air", {0, 0}},
      {"fuel_*", {layer, 2 * layer}},
      {"return_front_*", {layer, 2 * layer}},
      {"return_rear_*", {layer, 2 * layer}},
      {"intrex_*", {layer, 2 * layer}},
      {"secondary_*_lower_*", {2 * layer, 3 * layer}},
      {"burner_*", {3 * layer, 4 * layer}},
      {"secondary_*_upper_*", {4 * layer, 5 * layer}}};
  EXPECT_EQ(heights, expected);
}

TEST(Furnace, AWrongFileIsOneLineWithItsPlace) {
  EXPECT_TRUE(refuses(least + "hight_m = 3\n", "f.toml:9", "did you mean 'high_m'?"));
  EXPECT_TRUE(refuses(least + "kind = \"fule\"\n", "f.toml:9", "did you mean 'fuel'?"));
  EXPECT_TRUE(refuses(least + "[[opening]]\ninputs = \"fuel\"\nlow_m = 3\nhigh_m = 2\n", "f.toml:9",
                      "low_m at or below high_m"));
  EXPECT_TRUE(refuses(least + "[[opening]]\ninputs = \"fuel\"\nlow_m = 3\n", "f.toml:9",
                      "missing setting 'opening.high_m'"));
  EXPECT_TRUE(refuses("name = \"f\"\n[solids]\npacking_limit = 65\n", "f.toml:3", "from 0.01 to 1"));
  EXPECT_TRUE(
      refuses("name = \"f\"\n[solids]\npacking_limit = 0.65\n", "f.toml", "solids.density_kg_per_m3"));
  EXPECT_TRUE(refuses("name = \"f\"\n[solid]\n", "f.toml:2", "solid"));
  EXPECT_TRUE(refuses("name = \n", "f.toml:1", "no valid TOML"));
  EXPECT_TRUE(refuses(least + "[[mirror]]\nname = \"m\"\n", "f.toml:9", "missing setting 'mirror.axis'"));
}

TEST(Furnace, MustFitTheCases) {
  const auto furnace = parse_furnace(least, "f.toml");
  EXPECT_NO_THROW(expect_fits(furnace, inputs_of_a_furnace(), "f.toml"));
  EXPECT_THAT(flows_without_opening(furnace, inputs_of_a_furnace()), ElementsAre("fuel"));

  auto mistaken = furnace;
  mistaken.openings.push_back({.inputs = "fule"});
  EXPECT_ERROR(InputError, "did you mean 'fuel'?", expect_fits(mistaken, inputs_of_a_furnace(), "f.toml"));
  auto no_flow = furnace;
  no_flow.openings.push_back({.inputs = "air_temperature"});
  EXPECT_ERROR(InputError, "matches no gas flow", expect_fits(no_flow, inputs_of_a_furnace(), "f.toml"));
  auto twice = furnace;
  twice.openings.push_back({.inputs = "air_2"});
  EXPECT_ERROR(InputError, "'air_2' enters by two openings",
               expect_fits(twice, inputs_of_a_furnace(), "f.toml"));
}

TEST(Furnace, LimitsTheVolumeFractionAlone) {
  const auto furnace = parse_furnace(least, "f.toml");

  const auto fields = furnace.limited({field_info("solid_volume_fraction"), field_info("pressure")});

  EXPECT_EQ(fields[0].upper, 0.6);
  EXPECT_EQ(fields[0].lower, 0.0);
  EXPECT_FALSE(fields[1].upper.has_value());
}

}  // namespace
}  // namespace elrom::field
