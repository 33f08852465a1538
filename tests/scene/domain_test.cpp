#include "elrom/scene/domain.hpp"

#include "elrom/base/error.hpp"
#include "spheres_for_tests.hpp"
#include "support/throws.hpp"

namespace elrom::scene {
namespace {

using test::box;

TEST(SceneDomain, DistanceIsThatToTheNearestWall) {
  const Domain domain({box({}, {1, 2, 3})});

  EXPECT_DOUBLE_EQ(domain.distance({0.25, 1, 1}), 0.25);
  EXPECT_DOUBLE_EQ(domain.distance({0.5, 1, 2.9}), 3 - 2.9);
  EXPECT_DOUBLE_EQ(domain.distance({0.5, -0.5, 1}), -0.5);
}

TEST(SceneDomain, TurnedBoxKeepsItsVolumeAndDistances) {
  const Body turned =
      body_of({.name = "b", .low = {}, .high = {1, 2, 3}, .turn_axis = 'y', .turn_angle = test::pi / 2});
  const Domain domain({turned});

  EXPECT_NEAR(turned.volume(), 6, 1e-12);
  EXPECT_NEAR(domain.distance({1.5, 1, -0.25}), 0.25, 1e-12);  // x -> -z, z -> x
}

TEST(SceneDomain, TurnsRightHandedAboutEachAxis) {
  const double c = std::cos(0.5), s = std::sin(0.5);
  const std::array<Vec, 3> expected{{{2, 3 * c - 4 * s, 3 * s + 4 * c},
                                     {2 * c + 4 * s, 3, 4 * c - 2 * s},
                                     {2 * c - 3 * s, 2 * s + 3 * c, 4}}};
  for (std::size_t a = 0; a < 3; ++a) {
    const Body body =
        body_of({.name = "b", .low = {}, .high = {2, 3, 4}, .turn_axis = "xyz"[a], .turn_angle = 0.5});

    const Vec off = body.corners[7] - expected[a];
    EXPECT_NEAR(dot(off, off), 0, 1e-28) << a;
  }
}

TEST(SceneDomain, TaperedBoxHasTheVolumeOfAFrustum) {
  BoxShape shape{.name = "bottom", .low = {-1, -1, 0}, .high = {1, 1, 3}};
  shape.top = {{{-2, -2}, {2, 2}}};

  EXPECT_NEAR(body_of(shape).volume(), 3.0 / 3 * (4 + 16 + 8), 1e-12);
}

TEST(SceneDomain, PathEndsAtTheWallLessTheRadius) {
  const Domain domain({box({}, {1, 1, 1})});

  const auto exit = domain.first_exit({0.5, 0.5, 0.5}, {2, 0, 0}, 0.1, 10);

  ASSERT_NE(exit.side, nullptr);
  EXPECT_NEAR(exit.time, 0.2, 1e-15);
  EXPECT_EQ(exit.side->normal, (Vec{-1, 0, 0}));
  EXPECT_EQ(domain.first_exit({0.5, 0.5, 0.5}, {2, 0, 0}, 0.1, 0.1).side, nullptr);
}

TEST(SceneDomain, PathGoesOnIntoABodyThatReachesIn) {
  const Domain domain({box({}, {1, 1, 1}, "a"), box({0.5, 0.25, 0.25}, {3, 0.75, 0.75}, "arm")});

  const auto through = domain.first_exit({0.2, 0.5, 0.5}, {1, 0, 0}, 0.1, 10),
             beside = domain.first_exit({0.2, 0.2, 0.5}, {1, 0, 0}, 0.1, 10);

  EXPECT_NEAR(through.time, 2.7, 1e-12);
  EXPECT_NEAR(beside.time, 0.7, 1e-12);
}

TEST(SceneDomain, OpeningJoinsBodiesThatOnlyShareASide) {
  BoxShape bottom{.name = "bottom", .low = {-1, -1, 0}, .high = {1, 1, 2}};
  bottom.top = {{{-2, -2}, {2, 2}}};
  const std::vector<Body> bodies{body_of(bottom), box({-2, -2, 2}, {2, 2, 5}, "top")};
  const Domain open(bodies, {}, {"bottom.z_high", "top.z_low"}), shut(bodies);

  EXPECT_NEAR(open.first_exit({0, 0, 4}, {0, 0, -1}, 0.1, 100).time, 3.9, 1e-12);
  EXPECT_NEAR(shut.first_exit({0, 0, 4}, {0, 0, -1}, 0.1, 100).time, 1.9, 1e-12);
  // At the wall of the top, the leaning wall is met at the opening.
  EXPECT_NEAR(open.first_exit({1.9, 0, 4}, {0, 0, -1}, 0.1, 100).time, 2, 1e-9);
}

TEST(SceneDomain, OutletLetsTheCentreThrough) {
  const Domain domain({box({}, {1, 1, 1})}, {"box.z_high"});

  const auto exit = domain.first_exit({0.5, 0.5, 0.5}, {0, 0, 1}, 0.1, 10);

  EXPECT_NEAR(exit.time, 0.5, 1e-15);
  EXPECT_EQ(exit.side->kind, SideKind::outlet);
  EXPECT_TRUE(domain.has_left({0.5, 0.5, 1.01}));
  EXPECT_FALSE(domain.has_left({0.5, 1.01, 0.5}));
}

TEST(SceneDomain, CornerTouchesAllItsWalls) {
  const Domain domain({box({}, {1, 1, 1})});
  std::array<const Side*, 6> walls;

  EXPECT_EQ(domain.touching({0.05, 0.05, 0.95}, 0.1, walls), 3u);
  EXPECT_EQ(domain.touching({0.5, 0.5, 0.95}, 0.1, walls), 1u);
}

TEST(SceneDomain, PeriodicSidesHaveNoWall) {
  const Domain domain = test::periodic_cube(2);

  EXPECT_EQ(domain.first_exit({1, 1, 1}, {1, 2, 3}, 0.1, 100).side, nullptr);
  EXPECT_EQ(domain.wrapped({-0.5, 2.5, 1}), (Vec{1.5, 0.5, 1}));
  EXPECT_EQ(domain.images().nearest({1.5, -1.5, 0.5}), (Vec{-0.5, 0.5, 0.5}));
}

TEST(SceneDomain, RefusesWhatCannotBe) {
  EXPECT_ERROR(UsageError, "without volume", box({}, {1, 0, 1}));
  EXPECT_ERROR(UsageError, "did you mean 'box.z_high'", Domain({box({}, {1, 1, 1})}, {"box.z_hihg"}));
  EXPECT_ERROR(UsageError, "expected x, y or z", Domain({box({}, {1, 1, 1})}, {}, {}, {"w"}));
  EXPECT_ERROR(UsageError, "one upright box",
               Domain({box({}, {1, 1, 1}), box({}, {2, 1, 1}, "c")}, {}, {}, {"x"}));
}

}  // namespace
}  // namespace elrom::scene
