#include "elrom/networks/banding.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace elrom::networks {
namespace {

using ::testing::ElementsAre;

// Two planes, five columns; the column error is that of the mean over planes.
ScreeningResult five_columns() {
  ScreeningResult result;
  result.error = MatrixD(2, 5);
  result.error << 0.05, 0.10, 0.25, 0.60, 0.05, 0.15, 0.10, 0.25, NAN, 0.15;
  result.build_error = MatrixD(1, 5);
  result.build_error << 0.10, 0.10, 0.25, NAN, 0.0999;
  return result;
}

TEST(Banding, EdgesBelongToTheUpperBandAndEmptyBandsVanish) {
  const auto bands = make_bands(five_columns(), {.scope = "field", .edges = {0.1, 0.2, 0.3, 0.5}});

  ASSERT_EQ(bands.size(), 4u);
  EXPECT_EQ(bands[0].name, "0 to 0.1");
  EXPECT_THAT(bands[0].columns, ElementsAre(4));
  EXPECT_THAT(bands[1].columns, ElementsAre(0, 1));
  EXPECT_THAT(bands[2].columns, ElementsAre(2));
  EXPECT_EQ(bands[3].name, "from 0.5");
  EXPECT_THAT(bands[3].columns, ElementsAre(3)) << "an error that is no number is the hardest";
}

TEST(Banding, PlaneScopeGivesEveryCellToExactlyOneBand) {
  const auto bands = make_bands(five_columns(), {.scope = "plane", .edges = {0.1, 0.2, 0.3, 0.5}});

  MatrixD count = MatrixD::Zero(2, 5);
  for (const auto& band : bands) {
    for (std::size_t p = 0; p < 2; ++p) {
      for (std::size_t c = 0; c < band.columns.size(); ++c) {
        count(static_cast<Eigen::Index>(p), band.columns[c]) += band.mask[p * band.columns.size() + c];
      }
    }
  }
  EXPECT_EQ(count, MatrixD(MatrixD::Ones(2, 5)));
}

TEST(Banding, NoEdgesMakeOneBand) {
  const auto bands = make_bands(five_columns(), {.scope = "field", .edges = {}});

  ASSERT_EQ(bands.size(), 1u);
  EXPECT_EQ(bands[0].columns.size(), 5u);
}

TEST(Banding, EqualBandsIsAShareOfColumns) {
  auto other = five_columns();
  other.build_error(0, 2) = 0.31;

  EXPECT_DOUBLE_EQ(equal_bands(five_columns(), other, {0.1, 0.2, 0.3, 0.5}), 0.8);
}

}  // namespace
}  // namespace elrom::networks
