// Straight paths and the source's detection.
#include "elrom/scene/mover.hpp"

#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

MoverSettings of(Collisions kind) {
  auto settings = test::hard_spheres(0.9);
  settings.collisions = kind;
  return settings;
}

TEST(SceneMover, SpheresOfNoCollisionsPassThroughEachOther) {
  State state = test::empty_state();
  test::add(state, {0, 0, 0}, {1, 0, 0});
  test::add(state, {0.01, 0, 0}, {-1, 0, 0});
  const Domain domain;
  test::run(*make_mover(domain, of(Collisions::none)), state, 0.01, 2);
  EXPECT_DOUBLE_EQ(state.particles.place[0][0], 0.02);
  EXPECT_DOUBLE_EQ(state.particles.velocity[0][1], -1);
}

TEST(SceneMover, WallTakesItsShareAtTheExactTime) {
  const Domain domain({test::box({}, {1, 1, 1})});
  State state = test::empty_state();
  test::add(state, {0.5, 0.5, 0.5}, {1, 0.5, 0}, 0.2);
  auto settings = of(Collisions::none);
  settings.walls = {.normal_restitution = 0.5, .tangential_restitution = 0.8};

  test::run(*make_mover(domain, settings), state, 0.8, 1);

  EXPECT_NEAR(state.particles.velocity[0][0], -0.5, 1e-15);
  EXPECT_NEAR(state.particles.velocity[1][0], 0.4, 1e-15);
  EXPECT_NEAR(state.particles.place[0][0], 0.9 - 0.4 * 0.5, 1e-15);
  EXPECT_NEAR(state.particles.place[1][0], 0.5 + 0.4 * 0.5 + 0.4 * 0.4, 1e-15);
  EXPECT_EQ(state.tally.wall_hits, 1);
}

TEST(SceneMover, EveryMotionNamesWhoLeaves) {
  const Domain domain({test::box({}, {1, 1, 1})}, {"box.x_high"});
  for (const auto kind :
       {Collisions::none, Collisions::dem, Collisions::helscm, Collisions::helscm_document}) {
    State state = test::empty_state();
    test::add(state, {0.5, 0.5, 0.5}, {});
    test::add(state, {0.9, 0.5, 0.5}, {1, 0, 0});
    const auto mover = make_mover(domain, of(kind));
    test::run(*mover, state, 0.2, 1);
    EXPECT_THAT(state.leaving, testing::ElementsAre(1)) << collision_names.name(kind);
  }
}

TEST(SceneMover, SourcesDetectionCountsAPairAsOftenAsItOverlaps) {
  // The relative speed after is low, so that the pair still overlaps for some steps.
  const Domain domain;
  std::vector<std::int64_t> counts;
  for (const int n : {10, 1000}) {
    State state = test::empty_state();
    test::add(state, {0, 0, 0}, {1, 0, 0});
    test::add(state, {1.5e-3, 0, 0}, {-1, 0, 0});
    test::run(*make_mover(domain, of(Collisions::helscm_document)), state, 1e-3 / n, n);
    counts.push_back(state.tally.collisions);
    EXPECT_LT(state.particles.velocity[0][0], 0);
  }
  EXPECT_GT(counts[1], counts[0]);
}

TEST(SceneMover, SourcesDetectionMissesWhatPassedWithinAStep) {
  const Domain domain;
  State state = test::empty_state();
  test::add(state, {0, 0, 0}, {1, 0, 0});
  test::add(state, {5e-3, 0, 0}, {-1, 0, 0});
  test::run(*make_mover(domain, of(Collisions::helscm_document)), state, 5e-3, 1);
  EXPECT_EQ(state.tally.collisions, 0);
  EXPECT_EQ(state.particles.velocity[0][0], 1);
}

TEST(SceneMover, SourcesDetectionLosesMomentumWhereThreeMeet) {
  const Domain domain;
  State state = test::empty_state();
  test::add(state, {0, 0, 0}, {1, 0, 0});
  test::add(state, {0.8e-3, 0.3e-3, 0}, {-1, 0, 0});
  test::add(state, {0.8e-3, -0.6e-3, 0}, {-2, 0, 0});
  const double before = momentum_of(state.particles).x;
  test::run(*make_mover(domain, of(Collisions::helscm_document)), state, 1e-6, 1);
  EXPECT_GT(std::abs(momentum_of(state.particles).x - before), 0.05 * std::abs(before));
}

}  // namespace
}  // namespace elrom::scene
