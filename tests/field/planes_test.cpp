#include "elrom/field/planes.hpp"

#include <gmock/gmock.h>

#include "elrom/base/error.hpp"

namespace elrom::field {
namespace {

using ::testing::ElementsAre;

TEST(Planes, NothingSaidMeansAllOfWhateverMesh) {
  const Planes planes;

  EXPECT_TRUE(planes.all());
  EXPECT_THAT(planes.numbers(3), ElementsAre(0, 1, 2));
  EXPECT_THAT(planes.numbers(1), ElementsAre(0));
}

TEST(Planes, AListIsTakenAsItIs) {
  const Planes planes{1, 4};

  EXPECT_FALSE(planes.all());
  EXPECT_THAT(planes.numbers(5), ElementsAre(1, 4));
}

TEST(Planes, AListOutOfOrderOrEmptyIsRefused) {
  for (const std::vector<std::int32_t>& numbers : {std::vector<std::int32_t>{}, {-1}, {2, 1}, {2, 2}})
    EXPECT_THROW(Planes{numbers}, UsageError);
}

TEST(Planes, AnOpenEndReachesToTheMeshsLastPlane) {
  const auto planes = Planes::listed({4, 0, 3, 0, 1}, 3);

  EXPECT_FALSE(planes.all());
  EXPECT_THAT(planes.numbers(4), ElementsAre(0, 1, 3));
  EXPECT_THAT(planes.numbers(6), ElementsAre(0, 1, 3, 4, 5));
  EXPECT_TRUE(Planes::listed({}, 0).all());
}

TEST(Planes, WhatTheMeshLacksIsRefused) {
  EXPECT_THROW((void)Planes({1, 4}).numbers(4), UsageError);
  EXPECT_THROW((void)Planes::listed({}, 4).numbers(4), UsageError);
}

}  // namespace
}  // namespace elrom::field
