#include "elrom/field/catalogue.hpp"

#include <gmock/gmock.h>

#include "support/throws.hpp"

namespace elrom::field {
namespace {

using ::testing::ElementsAre;
using Names = std::vector<std::string>;

Names chosen(const Names& names) {
  Names result;
  for (const auto& info : choose_fields(standard_fields(), names)) result.push_back(info.name);
  return result;
}

TEST(ChooseFields, KeepsTheOrderOfTheNamesAndTakesAllWithoutAny) {
  EXPECT_THAT(chosen({"pressure", "gas_velocity_z"}), ElementsAre("pressure", "gas_velocity_z"));
  EXPECT_EQ(chosen({}).size(), standard_fields().size());
  EXPECT_EQ(choose_fields(standard_fields(), Names{"pressure"}).front().unit, "Pa");
}

TEST(KeepFields, KeepsTheOrderOfTheFields) {
  const auto kept = keep_fields(standard_fields(), Names{"pressure", "gas_velocity_z"});

  ASSERT_EQ(kept.size(), 2u);
  EXPECT_EQ(kept[0].name, "gas_velocity_z");
  EXPECT_EQ(keep_fields(standard_fields(), {}).size(), standard_fields().size());
  EXPECT_ERROR(UsageError, "did you mean 'pressure'?", keep_fields(standard_fields(), Names{"presure"}));
}

TEST(ChooseFields, AnUnknownNameIsRefusedWithTheNearest) {
  EXPECT_ERROR(UsageError, "unknown field 'presure' in fields.names; did you mean 'pressure'?",
               choose_fields(standard_fields(), Names{"pressure", "presure"}, "fields.names"));
  EXPECT_ERROR(InputError, "known are: solid_velocity_x",
               choose_fields<InputError>(standard_fields(), Names{"xylophone_of_glass"}));
}

}  // namespace
}  // namespace elrom::field
