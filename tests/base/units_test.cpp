#include "elrom/base/units.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"

namespace elrom::base {
namespace {

TEST(Units, ConvertBothWays) {
  EXPECT_DOUBLE_EQ(unit("t/h").to_si(3.6), 1.0);
  EXPECT_DOUBLE_EQ(unit("degC").to_si(26.85), 300.0);
  EXPECT_DOUBLE_EQ(unit("um").to_si(250), 250e-6);
  EXPECT_DOUBLE_EQ(unit("degC").from_si(unit("degC").to_si(812.5)), 812.5);
}

TEST(Units, UnknownSymbolListsTheKnownOnes) {
  try {
    (void)unit("furlong");
    FAIL() << "expected an InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("unknown unit 'furlong'"));
    EXPECT_THAT(error.what(), testing::HasSubstr("kg/s"));
  }
}

TEST(Units, HeadingSplitsIntoNameAndUnit) {
  const auto with = split_unit(" primary_air [kg/s] ");
  EXPECT_EQ(with.name, "primary_air");
  EXPECT_EQ(with.symbol, "kg/s");
  EXPECT_EQ(split_unit("case").symbol, "");
  EXPECT_EQ(split_unit("odd [").name, "odd [");
}

TEST(Units, DimensionsListTheirSymbols) { EXPECT_THAT(units_of("kg/s"), testing::Contains("t/h")); }

}  // namespace
}  // namespace elrom::base
