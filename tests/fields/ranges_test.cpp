#include "elrom/fields/ranges.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"

namespace elrom::fields {
namespace {

using ::testing::ElementsAre;

TEST(Ranges, PlanesAreHalfOpenRangesAndSingles) {
  EXPECT_THAT(parse_planes("3").numbers(5), ElementsAre(3));
  EXPECT_THAT(parse_planes("0:2").numbers(5), ElementsAre(0, 1));
  EXPECT_THAT(parse_planes("3:").numbers(5), ElementsAre(3, 4));
  EXPECT_THAT(parse_planes(":1, 4 ,0:2").numbers(5), ElementsAre(0, 1, 4));
  EXPECT_THAT(parse_planes("4:,0,2:3,3:").numbers(6), ElementsAre(0, 2, 3, 4, 5));
  EXPECT_TRUE(parse_planes(":").all());
}

TEST(Ranges, PlanesThatAreNotThereAreRefused) {
  for (const char* text : {"5", "0:6", "5:", "2:2", "3:1", "-1", "a", "", "1:2:3", "1,", "1.5",
                           "99999999999999999999", "0:2000000000"}) {
    EXPECT_THROW((void)parse_planes(text).numbers(5), UsageError) << text;
  }
}

TEST(Ranges, ABoxMayLeaveSidesOut) {
  const auto box = parse_box("1:2.5,:,-3:");

  EXPECT_THAT(box.low, ElementsAre(1, -model::Box::infinity, -3));
  EXPECT_THAT(box.high, ElementsAre(2.5, model::Box::infinity, model::Box::infinity));
}

TEST(Ranges, BrokenBoxesAreRefused) {
  for (const char* text :
       {"", "1:2", "1:2,3:4", "2:1,:,:", "1:1,:,:", "a:,:,:", "1,2,3", ":,:,:,:", "nan:,:,:"}) {
    EXPECT_THROW((void)parse_box(text), UsageError) << text;
  }
}

}  // namespace
}  // namespace elrom::fields
