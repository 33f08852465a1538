#include "elrom/base/enum_names.hpp"

#include <gmock/gmock.h>

#include <stdexcept>

#include "support/throws.hpp"

namespace elrom::base {
namespace {

enum class Colour { red, green, blue };
constexpr EnumNames<Colour, 3> colours{
    "colour", {{Colour::green, "green"}, {Colour::red, "red"}, {Colour::blue, "blue"}}};

TEST(EnumNames, NamesAndValuesAreOneToOneInAnyOrder) {
  for (const auto colour : {Colour::red, Colour::green, Colour::blue})
    EXPECT_EQ(colours.value(colours.name(colour)), colour);
  EXPECT_EQ(colours.name(Colour::red), "red");
  EXPECT_EQ(colours.find("blue"), Colour::blue);
  static_assert(colours.name(Colour::green) == "green");
}

TEST(EnumNames, AnUnknownNameIsRefusedWithTheNearest) {
  EXPECT_ERROR(InputError, "unknown colour: found 'geen'; did you mean 'green'?", colours.value("geen"));
  EXPECT_ERROR(UsageError, "known are: green, red, blue", colours.value<UsageError>("transparent"));
  EXPECT_FALSE(colours.find("Red"));
  EXPECT_FALSE(colours.find(""));
}

TEST(EnumNames, AValueWithoutANameIsOurMistake) {
  EXPECT_THROW(static_cast<void>(colours.name(static_cast<Colour>(7))), std::logic_error);
}

}  // namespace
}  // namespace elrom::base
