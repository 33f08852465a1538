// Every hard case through every stage ends in finite numbers or one clear error, never a hang, never a NaN.

#include <gmock/gmock.h>

#include "stages.hpp"
#include "support/temporary_folder.hpp"

namespace elrom::stability {
namespace {

class HardCase : public ::testing::TestWithParam<HardData> {};

TEST_P(HardCase, EndsInFiniteNumbersOrAClearError) {
  const test::TemporaryFolder folder;

  for (const auto& outcome : send_through(GetParam(), folder.path())) {
    EXPECT_TRUE(outcome.passed) << outcome.stage << ": " << outcome.result;
  }
}

INSTANTIATE_TEST_SUITE_P(Data, HardCase, ::testing::ValuesIn(all_hard_data()),
                         [](const auto& one) { return one.param.name; });

TEST(HealthyCase, IsRefusedNowhere) {
  const test::TemporaryFolder folder;

  for (const auto& outcome : send_through(all_hard_data().front(), folder.path())) {
    if (outcome.stage == "diverging_fit")
      EXPECT_THAT(outcome.result, ::testing::HasSubstr("refused: every build of submodel"));
    else
      EXPECT_EQ(outcome.result, "finite") << outcome.stage;
  }
}

}  // namespace
}  // namespace elrom::stability
