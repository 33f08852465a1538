#include "elrom/networks/trainer.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace elrom::networks {
namespace {

TEST(EpochPart, EverySweepVisitsEachRecordOnceInAsFewEqualPiecesAsMayBe) {
  std::vector<int> visits(10, 0);
  for (std::size_t epoch = 6; epoch < 9; ++epoch) {
    const EpochPart part = epoch_part(10, 4, epoch);
    EXPECT_EQ(part.sweep, 2U);
    EXPECT_TRUE(part.size == 3 || part.size == 4);
    for (std::size_t i = part.first; i < part.first + part.size; ++i) ++visits[i];
  }
  EXPECT_EQ(visits, std::vector<int>(10, 1));
}

TEST(EpochPart, IsAllOfThemWithoutALimitAndWhereTheyAreFew) {
  for (const int most : {0, 10, 11}) {
    const EpochPart part = epoch_part(10, most, 5);
    EXPECT_EQ(part.sweep, 5U);
    EXPECT_EQ(part.first, 0U);
    EXPECT_EQ(part.size, 10U);
  }
}

TEST(RateFactor, FallsByHalfACosine) {
  const TrainingBudget budget{.max_epochs = 12, .anneal = true};
  EXPECT_EQ(rate_factor(budget, 0), 1);
  EXPECT_NEAR(rate_factor(budget, 4), 0.75, 1e-12);
  EXPECT_NEAR(rate_factor(budget, 6), 0.5, 1e-12);
  EXPECT_NEAR(rate_factor(budget, 11), 0.017, 1e-3);
  EXPECT_EQ(rate_factor({.max_epochs = 12}, 11), 1);
}

}  // namespace
}  // namespace elrom::networks
