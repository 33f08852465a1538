#include "elrom/base/text.hpp"

#include <gmock/gmock.h>

namespace elrom::base {
namespace {

TEST(Text, ClosestNameFindsASlipOfThePen) {
  const std::vector<std::string> known{"primary_air", "burner_left", "burner_right"};

  EXPECT_EQ(closest_name("primry_air", known), "primary_air");
  EXPECT_EQ(closest_name("burner_rigth", known), "burner_right");
  EXPECT_EQ(closest_name("pressure", known), std::nullopt);
  EXPECT_EQ(closest_name("air_x", {"air", "air_y"}), "air_y");
}

TEST(Text, LettersInTheWrongOrderAreOneSlip) {
  EXPECT_EQ(closest_name("htlm", {"help", "html"}), "html");
  EXPECT_EQ(closest_name("dfif", {"fit", "diff"}), "diff");
  EXPECT_EQ(closest_name("casse", {"case", "cases"}), "cases") << "as near, but of the same letters";
  EXPECT_EQ(closest_name("caes", {"case", "cases"}), "case");
}

TEST(Text, MatchesShellPatterns) {
  EXPECT_TRUE(matches("load_064", "load_*"));
  EXPECT_TRUE(matches("rep1_064", "rep?_*"));
  EXPECT_TRUE(matches("anything", "*"));
  EXPECT_FALSE(matches("train_001", "load_*"));
  EXPECT_FALSE(matches("load", "load_*"));
  EXPECT_FALSE(matches("bcdx", "*bcd*c*")) << "what a star has passed is not looked at again";
}

TEST(Text, NumbersReadBackExactly) {
  for (const double value : {0.1, 1e-300, -273.15, 12345678.9}) EXPECT_EQ(to_double(number(value)), value);
  EXPECT_EQ(to_double("1.5kg"), std::nullopt);
  EXPECT_EQ(to_double(""), std::nullopt);
  EXPECT_EQ(to_double("+2"), 2.0);
}

TEST(Text, DurationsAreInTheUnitThatFits) {
  EXPECT_EQ(duration(0.25), "250 ms");
  EXPECT_EQ(duration(1), "1.0 s");
  EXPECT_EQ(duration(59.9), "59.9 s");
  EXPECT_EQ(duration(61), "1 min 01 s");
  EXPECT_EQ(duration(3599), "59 min 59 s");
  EXPECT_EQ(duration(3600), "1 h 00 min");
  EXPECT_EQ(duration(7500), "2 h 05 min");
}

TEST(Text, PartsBetweenSeparatorsMayBeEmpty) {
  EXPECT_EQ(split("a,,b", ','), (std::vector<std::string>{"a", "", "b"}));
  EXPECT_EQ(split("", ','), std::vector<std::string>{""});
  EXPECT_EQ(split("a,", ','), (std::vector<std::string>{"a", ""}));
}

}  // namespace
}  // namespace elrom::base
