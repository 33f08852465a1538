// Collisions at their exact times: hand values, invariants, independence of the step.
#include "elrom/base/error.hpp"
#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

TEST(SceneSwept, HeadOnPairSwapsItsVelocities) {
  State state = test::empty_state();
  test::add(state, {-0.01, 0, 0}, {1, 0, 0});
  test::add(state, {0.01, 0, 0}, {-2, 0, 0});
  const Domain domain;
  const auto mover = make_mover(domain, test::hard_spheres(1));

  test::run(*mover, state, 0.1, 1);

  // They meet after 19 mm at 3 m/s, 2nd at -0.01 + 0.019/3 + 1e-3.
  const auto& p = state.particles;
  const double t = 0.019 / 3;
  EXPECT_NEAR(p.velocity[0][0], -2, 1e-12);
  EXPECT_NEAR(p.velocity[0][1], 1, 1e-12);
  EXPECT_NEAR(p.place[0][0], -0.01 + t - 2 * (0.1 - t), 1e-12);
  EXPECT_EQ(state.tally.collisions, 1);
}

TEST(SceneSwept, UnequalSpheresConserveMomentumAndLoseWhatRestitutionSays) {
  State state = test::empty_state();
  test::add(state, {0, 0, 0}, {3, 0, 0}, 1e-3);
  test::add(state, {0.01, 0, 0}, {-1, 0, 0}, 2e-3);
  const Domain domain;
  const auto mover = make_mover(domain, test::hard_spheres(0.5));
  const Vec before = momentum_of(state.particles);

  test::run(*mover, state, 0.02, 1);

  const Vec after = momentum_of(state.particles);
  EXPECT_NEAR(after.x, before.x, 1e-15 * std::abs(before.x) + 1e-22);
  EXPECT_NEAR(state.particles.velocity[0][1] - state.particles.velocity[0][0], 2, 1e-12);
}

TEST(SceneSwept, ThreeInARowCollideInTheOrderOfTime) {
  // Newton's cradle: the middle sphere passes it on, within one step.
  State state = test::empty_state();
  test::add(state, {0, 0, 0}, {1, 0, 0});
  test::add(state, {0.003, 0, 0}, {});
  test::add(state, {0.006, 0, 0}, {});
  const Domain domain;
  const auto mover = make_mover(domain, test::hard_spheres(1));

  test::run(*mover, state, 0.1, 1);

  EXPECT_EQ(state.tally.collisions, 2);
  EXPECT_NEAR(state.particles.velocity[0][0], 0, 1e-12);
  EXPECT_NEAR(state.particles.velocity[0][2], 1, 1e-12);
  EXPECT_NEAR(state.particles.place[0][1], 0.005, 1e-12);
}

TEST(SceneSwept, CountAndOutcomeDoNotDependOnTheStep) {
  // The same cloud by one step and by a thousand. Chaos lets places part in the end, counts stay.
  const double edge = 0.02;
  const Domain domain = test::periodic_cube(edge);
  std::vector<double> counts, energies;
  for (const int n : {1, 10, 1000}) {
    State state = test::cloud(1000, edge, 1e-3, 1);
    const auto mover = make_mover(domain, test::hard_spheres(0.9));
    test::run(*mover, state, 5e-3 / n, n);
    counts.push_back(static_cast<double>(state.tally.collisions));
    energies.push_back(kinetic_energy_of(state.particles));
  }
  EXPECT_GT(counts[0], 2000);
  EXPECT_NEAR(counts[1], counts[0], 0.02 * counts[0]);
  EXPECT_NEAR(counts[2], counts[0], 0.02 * counts[0]);
  EXPECT_NEAR(energies[2], energies[0], 0.02 * energies[0]);
}

TEST(SceneSwept, ShortRunsAgreeToRoundingWhateverTheStep) {
  const double edge = 0.02;
  const Domain domain = test::periodic_cube(edge);
  State one = test::cloud(1000, edge, 1e-3, 1), many = one;
  test::run(*make_mover(domain, test::hard_spheres(0.9)), one, 4e-4, 1);
  test::run(*make_mover(domain, test::hard_spheres(0.9)), many, 1e-6, 400);

  EXPECT_EQ(one.tally.collisions, many.tally.collisions);
  EXPECT_GT(one.tally.collisions, 150);
  for (std::size_t i = 0; i < 1000; ++i) {
    const Vec d = domain.images().nearest(get(one.particles.place, i) - get(many.particles.place, i));
    EXPECT_LT(std::sqrt(dot(d, d)), 1e-9);
  }
}

TEST(SceneSwept, ThreadsGiveTheSameBits) {
  const double edge = 0.04;
  const Domain domain({test::box({}, {edge, edge, edge})});
  State one = test::cloud(5000, edge, 1e-3, 1), three = one;
  test::run(*make_mover(domain, test::hard_spheres(0.8, 1)), one, 1e-3, 3);
  test::run(*make_mover(domain, test::hard_spheres(0.8, 3)), three, 1e-3, 3);

  test::expect_same_bits(one.particles, three.particles);
  EXPECT_EQ(one.tally.collisions, three.tally.collisions);
}

TEST(SceneSwept, NoPairOverlapsAndEnergyNeverGrows) {
  const double edge = 0.02;
  const Domain domain({test::box({}, {edge, edge, edge})});
  State state = test::cloud(1500, edge * 0.95, 1e-3, 2, 1, true);
  for (auto& x : state.particles.place)
    for (auto& value : x) value = std::clamp(value, 0.5e-3, edge - 0.5e-3);
  const auto mover = make_mover(domain, test::hard_spheres(0.9, 1, 0.3));
  const std::size_t at_start = overlaps_of(state.particles, domain, 1e-6, 1).n;
  double energy = kinetic_energy_of(state.particles);
  for (int k = 0; k < 20; ++k) {
    test::run(*mover, state, 5e-4, 1);
    const double now = kinetic_energy_of(state.particles);
    EXPECT_LE(now, energy * (1 + 1e-12));
    energy = now;
  }
  EXPECT_LE(overlaps_of(state.particles, domain, 1e-6, 1).n, at_start);
  for (std::size_t i = 0; i < 1500; ++i)
    EXPECT_GT(domain.distance(get(state.particles.place, i)), 0.5e-3 - 1e-9);
  EXPECT_GT(state.tally.wall_hits, 100);
}

TEST(SceneSwept, FastSphereIsNotLostAndCrossesNoWall) {
  // 200 m/s across 20 mm a hundred times in a step.
  const Domain domain({test::box({}, {0.02, 0.02, 0.02})});
  State state = test::empty_state();
  test::add(state, {0.01, 0.01, 0.01}, {200, 100, 50});
  test::add(state, {0.005, 0.005, 0.005}, {});

  test::run(*make_mover(domain, test::hard_spheres(1)), state, 0.01, 1);

  EXPECT_NEAR(kinetic_energy_of(state.particles), 0.5 * state.particles.mass[0] * 52500, 1e-8);
  EXPECT_GE(domain.distance(get(state.particles.place, 0)), 0.5e-3 - 1e-9);
  EXPECT_GT(state.tally.wall_hits, 100);
}

TEST(SceneSwept, SpheresAtRestOnEachOtherDoNotCollideForEver) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.1})});
  State state = test::empty_state();
  state.particles.remembers_hits = true;
  for (int k = 0; k < 10; ++k) test::add(state, {0.005, 0.005, 0.00051 + 0.00101 * k}, {});
  auto settings = test::hard_spheres(0.7);
  settings.walls.normal_restitution = 0.7;
  settings.contact_time = 1e-5;
  const auto mover = make_mover(domain, settings);
  for (int k = 0; k < 200; ++k) {
    for (auto& w : state.particles.velocity[2]) w -= 9.81 * 1e-3;
    test::run(*mover, state, 1e-3, 1);
  }
  EXPECT_NEAR(state.particles.place[2][9], 0.0095, 5e-4);
  EXPECT_LT(greatest_speed_of(state.particles), 0.2);
}

TEST(SceneSwept, NothingIsNoMistake) {
  State state = test::empty_state();
  const Domain domain;
  test::run(*make_mover(domain, test::hard_spheres(1)), state, 1, 2);
  EXPECT_EQ(state.tally.collisions, 0);
}

}  // namespace
}  // namespace elrom::scene
