#include "elrom/field/possible_inputs.hpp"

#include <gmock/gmock.h>

#include <limits>
#include <string>

#include "elrom/base/error.hpp"

namespace elrom::field {
namespace {

using ::testing::HasSubstr;

const InputSchema& possible_schema() {
  static const InputSchema schema{{{"primary_air", "kg/s", "kg/s"},
                                   {"gas_temperature", "K", "K"},
                                   {"return_left_fraction", "1", "1"},
                                   {"gas_density", "kg/m3", "kg/m3"},
                                   {"valve", "1", "1"},
                                   {"solids_spread", "1", "1"},
                                   {"air_ratio", "1", "1"}}};
  return schema;
}

// What is said of a case; nothing of one that can be.
std::string refusal_of(std::size_t changed, double value) {
  CaseInputs inputs{.name = "c", .load = 1, .values = {100, 1150, 0.5, 0.3, -7, 1.5, 1.2}};
  inputs.values[changed] = value;
  try {
    check_possible(inputs, possible_schema());
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(PossibleInputs, EveryInputIsLookedAt) {
  EXPECT_EQ(refusal_of(0, 100), "");
  EXPECT_THAT(refusal_of(0, -1), HasSubstr("impossible primary_air"));
  EXPECT_THAT(refusal_of(1, -1), HasSubstr("impossible gas_temperature"));
  EXPECT_THAT(refusal_of(2, -1), HasSubstr("impossible return_left_fraction"));
  EXPECT_THAT(refusal_of(3, -1), HasSubstr("impossible gas_density"));
  EXPECT_THAT(refusal_of(4, 1e13), HasSubstr("impossible valve"));
  EXPECT_THAT(refusal_of(5, -0.1), HasSubstr("impossible solids_spread"));
  EXPECT_THAT(refusal_of(6, -1), HasSubstr("impossible air_ratio"));
}

TEST(PossibleInputs, EndsOfRangesArePossibleWhereNatureAllowsThem) {
  EXPECT_EQ(refusal_of(0, 0), "");
  EXPECT_EQ(refusal_of(0, 1e6), "");
  EXPECT_THAT(refusal_of(0, 1.1e6), HasSubstr("0 kg/s to 1e+06 kg/s"));
  EXPECT_THAT(refusal_of(1, 0), HasSubstr("above 0 K")) << "nothing is at absolute zero";
  EXPECT_EQ(refusal_of(2, 0), "");
  EXPECT_EQ(refusal_of(2, 1), "");
  EXPECT_NE(refusal_of(2, 1.001), "");
  EXPECT_NE(refusal_of(3, 0), "");
  EXPECT_EQ(refusal_of(4, -1e12), "") << "a unit that nothing is known of";
  EXPECT_NE(refusal_of(4, std::numeric_limits<double>::quiet_NaN()), "");
}

}  // namespace
}  // namespace elrom::field
