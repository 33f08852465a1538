#include "elrom/base/text.hpp"

#include <gmock/gmock.h>

namespace elrom::base {
namespace {

TEST(Text, ClosestNameFindsASlipOfThePen) {
  const std::vector<std::string> known{"primary_air", "burner_left", "burner_right"};

  EXPECT_EQ(closest_name("primry_air", known), "primary_air");
  EXPECT_EQ(closest_name("burner_rigth", known), "burner_right");
  EXPECT_EQ(closest_name("pressure", known), std::nullopt);
}

TEST(Text, MatchesShellPatterns) {
  EXPECT_TRUE(matches("load_064", "load_*"));
  EXPECT_TRUE(matches("rep1_064", "rep?_*"));
  EXPECT_TRUE(matches("anything", "*"));
  EXPECT_FALSE(matches("train_001", "load_*"));
  EXPECT_FALSE(matches("load", "load_*"));
}

TEST(Text, NumbersReadBackExactly) {
  for (const double value : {0.1, 1e-300, -273.15, 12345678.9}) EXPECT_EQ(to_double(number(value)), value);
  EXPECT_EQ(to_double("1.5kg"), std::nullopt);
  EXPECT_EQ(to_double(""), std::nullopt);
  EXPECT_EQ(to_double("+2"), 2.0);
}

}  // namespace
}  // namespace elrom::base
