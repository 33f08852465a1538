#include "elrom/base/units.hpp"

#include <gmock/gmock.h>

#include <map>

#include "elrom/base/error.hpp"
#include "support/throws.hpp"

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

TEST(Units, AnotherSpellingIsAnsweredWithTheOneThatIsMeant) {
  for (const auto& [written, meant] : std::map<std::string, std::string>{{"kg/sec", "kg/s"},
                                                                         {"KG/S", "kg/s"},
                                                                         {"tph", "t/h"},
                                                                         {"T/hr", "t/h"},
                                                                         {"micron", "um"},
                                                                         {"PA", "Pa"},
                                                                         {"Celsius", "degC"}})
    EXPECT_ERROR(InputError, "unknown unit '" + written + "'; did you mean '" + meant + "'?", unit(written));
  EXPECT_ERROR(InputError, "unknown unit 'barg'; known are: ", unit("barg"));
}

TEST(Units, HeadingSplitsIntoNameAndUnit) {
  const auto with = split_unit(" primary_air [kg/s] ");
  EXPECT_EQ(with.name, "primary_air");
  EXPECT_EQ(with.symbol, "kg/s");
  EXPECT_EQ(split_unit("case").symbol, "");
  EXPECT_EQ(split_unit("odd [").name, "odd [");
}

TEST(Units, DimensionsListTheirSymbols) { EXPECT_THAT(units_of("kg/s"), testing::Contains("t/h")); }

TEST(Units, FilesMayBringFurtherOnes) {
  EXPECT_FALSE(is_common_unit("cubit"));
  know_unit({"cubit", "m", 0.4572});
  EXPECT_DOUBLE_EQ(unit("cubit").to_si(2), 0.9144);
  EXPECT_THAT(units_of("m"), testing::Contains("cubit"));
  know_unit({"cubit", "m", 0.4572 * (1 + 1e-12)});
  EXPECT_ERROR(InputError, "unit 'cubit' means something else", know_unit({"cubit", "m", 0.5}));
  EXPECT_ERROR(InputError, "unit 't/h' means something else", know_unit({"t/h", "kg/s", 1}));
  EXPECT_ERROR(InputError, "no unit", know_unit({"naught", "m", 0}));
  EXPECT_ERROR(InputError, "no unit", know_unit({"", "m", 1}));
  know_unit({"ZW/m2", "W/m2", 1e21});
  EXPECT_EQ(unit("W/m2").to_si(3), 3);
}

TEST(Units, UnknownSymbolsAreAskedOfTheSource) {
  int asked = 0;
  set_unit_source([&](std::string_view symbol) {
    ++asked;
    return symbol == "ell" ? std::optional(Unit{"ell", "m", 1.143}) : std::nullopt;
  });
  EXPECT_DOUBLE_EQ(unit("ell").factor, 1.143);
  EXPECT_DOUBLE_EQ(unit("kg/s").factor, 1);
  EXPECT_DOUBLE_EQ(unit("ell").factor, 1.143);
  EXPECT_EQ(asked, 1);
  EXPECT_ERROR(InputError, "unknown unit 'elk'", unit("elk"));
  set_unit_source({});
}

TEST(Units, QuantitiesMayHaveAUnitWithOrWithoutASpace) {
  EXPECT_DOUBLE_EQ(quantity("315um", "m"), 315e-6);
  EXPECT_DOUBLE_EQ(quantity(" 315 \u00b5m ", "m"), 315e-6);
  EXPECT_DOUBLE_EQ(quantity("1 mm", "m"), 1e-3);
  EXPECT_DOUBLE_EQ(quantity("+2.5e-3", "m"), 2.5e-3);
  EXPECT_DOUBLE_EQ(quantity("1e2kN/m", "N/m"), 1e5);
  EXPECT_DOUBLE_EQ(quantity("90 %", "1"), 0.9);
  EXPECT_EQ(split_quantity("60 t/h")->symbol, "t/h");
}

TEST(Units, QuantitiesOfAnotherKindAreRefused) {
  EXPECT_ERROR(InputError, "no finite number: found 'um'", quantity("um", "m"));
  EXPECT_ERROR(InputError, "no finite number: found ''", quantity("", "m"));
  EXPECT_ERROR(InputError, "no finite number: found 'nan'", quantity("nan", "m"));
  EXPECT_ERROR(InputError, "no finite number", quantity("1e999", "m"));
  EXPECT_ERROR(InputError, "unknown unit 'parsec'", quantity("3 parsec", "m"));
  EXPECT_ERROR(InputError, "another dimension: found 'kg', expected m, mm, um", quantity("3 kg", "m"));
}

TEST(Units, RangesShareTheUnitOfTheirSecondEnd) {
  const auto both = [](std::string_view text, std::string_view si) {
    const auto [low, high] = interval(text, si);
    return std::vector{low, high};
  };
  EXPECT_EQ(both("0:20", "m/s"), (std::vector{0.0, 20.0}));
  EXPECT_EQ(both("300:354um", "m"), (std::vector{quantity("300um", "m"), quantity("354um", "m")}));
  EXPECT_EQ(both("300um:1 mm", "m"), (std::vector{quantity("300um", "m"), 1e-3}));
  EXPECT_EQ(both("2 m/s", "m/s"), (std::vector{2.0, 2.0}));
  EXPECT_ERROR(InputError, "no finite number", interval("3:", "m"));
  EXPECT_ERROR(InputError, "no range: found '1:2:3', expected low:high", interval("1:2:3", "m"));
}

}  // namespace
}  // namespace elrom::base
