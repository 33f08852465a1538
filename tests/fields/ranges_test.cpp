#include "ranges.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"

namespace elrom::fields {
namespace {

using ::testing::ElementsAre;

TEST(Ranges, PlanesAreHalfOpenRangesAndSingles) {
  EXPECT_THAT(parse_planes("", 5), ElementsAre());
  EXPECT_THAT(parse_planes("3", 5), ElementsAre(3));
  EXPECT_THAT(parse_planes("0:2", 5), ElementsAre(0, 1));
  EXPECT_THAT(parse_planes("3:", 5), ElementsAre(3, 4));
  EXPECT_THAT(parse_planes(":1, 4 ,0:2", 5), ElementsAre(0, 1, 4));
}

TEST(Ranges, PlanesThatAreNotThereAreRefused) {
  for (const char* text :
       {"5", "0:6", "2:2", "3:1", "-1", "a", "1:2:3", "1,", "1.5", "99999999999999999999"}) {
    EXPECT_THROW((void)parse_planes(text, 5), UsageError) << text;
  }
}

TEST(Ranges, ABoxMayLeaveSidesOut) {
  const auto box = parse_box("1:2.5,:,-3:");

  EXPECT_THAT(box.low, ElementsAre(1, -Box::infinity, -3));
  EXPECT_THAT(box.high, ElementsAre(2.5, Box::infinity, Box::infinity));
}

TEST(Ranges, BrokenBoxesAreRefused) {
  for (const char* text :
       {"", "1:2", "1:2,3:4", "2:1,:,:", "1:1,:,:", "a:,:,:", "1,2,3", ":,:,:,:", "nan:,:,:"}) {
    EXPECT_THROW((void)parse_box(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace elrom::fields
