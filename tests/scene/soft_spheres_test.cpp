// Many soft spheres against one pair (particle/pair_solver.hpp), hand values and invariants.
#include "elrom/particle/pair_solver.hpp"
#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

using particle::ContactLaw;
using particle::LawKind;

const Domain everywhere;

// Two spheres that meet obliquely and spin.
State meeting() {
  State state = test::empty_state(true);
  test::add(state, {-1e-3, 0, 0}, {2, 0.3, 0}, 1e-3);
  test::add(state, {1e-3, 0.4e-3, 0}, {-1, 0, 0.5}, 1.5e-3, 2000);
  state.particles.spin[2] = {300, -200};
  return state;
}

struct Apart {
  Vec velocity, spin;
};

// The same, by the two-particle DEM from where they touch.
Apart by_pair_solver(const State& state, const ContactLaw& law) {
  const auto& p = state.particles;
  const Vec d = get(p.place, 1) - get(p.place, 0), w = get(p.velocity, 1) - get(p.velocity, 0);
  const double reach = 0.5 * (p.diameter[0] + p.diameter[1]), b = dot(d, w), c = dot(d, d) - reach * reach;
  const double t = c / (-b + std::sqrt(b * b - dot(w, w) * c));
  const Vec normal = (1 / reach) * (d + t * w);
  particle::Pairs pairs(1);
  const auto put = [](particle::Components& to, const Vec& v) { to.row(0) << v.x, v.y, v.z; };
  put(pairs.before.velocity_1, get(p.velocity, 0)), put(pairs.before.velocity_2, get(p.velocity, 1));
  put(pairs.before.spin_1, get(p.spin, 0)), put(pairs.before.spin_2, get(p.spin, 1));
  put(pairs.normal, normal);
  pairs.diameter_1 = p.diameter[0], pairs.diameter_2 = p.diameter[1];
  pairs.density_1 = p.density[0], pairs.density_2 = p.density[1];
  const auto after = particle::collide(pairs, law).after;
  const auto row = [](const particle::Components& v) { return Vec{v(0, 0), v(0, 1), v(0, 2)}; };
  return {row(after.velocity_1), row(after.spin_1)};
}

void expect_near(const Vec& a, const Vec& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_as_pair_solver(const ContactLaw& law) {
  State state = meeting();
  const auto expected = by_pair_solver(state, law);
  auto settings = test::soft_spheres(law);
  settings.steps_per_contact = 400;
  test::run(*make_mover(everywhere, settings), state, 2e-3, 1);
  expect_near(get(state.particles.velocity, 0), expected.velocity, 3e-3);
  if (law.friction > 0) expect_near(get(state.particles.spin, 0), expected.spin, 6);
  EXPECT_EQ(state.tally.collisions, 1);
}

TEST(SceneSoftSpheres, PairEndsAsThePairSolverSays) {
  expect_as_pair_solver({.restitution = 0.9, .stiffness = 1e5});
  expect_as_pair_solver({.restitution = 0.8, .friction = 0.3, .stiffness = 1e5});
  expect_as_pair_solver({.kind = LawKind::hertz, .restitution = 0.9, .youngs_modulus = 1e9});
  expect_as_pair_solver({.kind = LawKind::hertz, .restitution = 0.9, .friction = 0.4, .youngs_modulus = 1e9});
}

TEST(SceneSoftSpheres, RestitutionHoldsAtTheUsualStep) {
  for (const auto kind : {LawKind::linear, LawKind::hertz}) {
    State state = test::empty_state();
    test::add(state, {-1e-3, 0, 0}, {1, 0, 0});
    test::add(state, {1e-3, 0, 0}, {-1, 0, 0});
    const ContactLaw law{.kind = kind, .restitution = 0.9, .stiffness = 1e5, .youngs_modulus = 1e9};
    test::run(*make_mover(everywhere, test::soft_spheres(law)), state, 2e-3, 1);
    EXPECT_NEAR(state.particles.velocity[0][1] - state.particles.velocity[0][0], 1.8, 0.02);
  }
}

TEST(SceneSoftSpheres, MomentumIsExactAndEnergyFalls) {
  const double edge = 0.02;
  const Domain domain = test::periodic_cube(edge);
  State state = test::cloud(800, edge, 1e-3, 1, 1, true);
  const ContactLaw law{.restitution = 0.8, .friction = 0.3, .stiffness = 1e4};
  const Vec before = momentum_of(state.particles);
  const double energy = kinetic_energy_of(state.particles), scale = mass_of(state.particles);

  test::run(*make_mover(domain, test::soft_spheres(law)), state, 1e-3, 5);

  const Vec change = momentum_of(state.particles) - before;
  EXPECT_LT(std::sqrt(dot(change, change)), 1e-13 * scale);
  EXPECT_LT(kinetic_energy_of(state.particles), 0.95 * energy);
  EXPECT_GT(state.tally.collisions, 500);
}

TEST(SceneSoftSpheres, ElasticCloudKeepsItsEnergy) {
  const double edge = 0.02;
  const Domain domain({test::box({}, {edge, edge, edge})});
  State state = test::cloud(500, 0.9 * edge, 1e-3, 1);
  for (auto& x : state.particles.place)
    for (auto& value : x) value += 1e-3;
  const double energy = kinetic_energy_of(state.particles);
  auto settings = test::soft_spheres({.restitution = 1, .stiffness = 1e5});
  settings.walls.kind = Walls::dem;
  test::run(*make_mover(domain, settings), state, 1e-3, 10);
  // What is in contact now holds some of it as spring.
  EXPECT_NEAR(kinetic_energy_of(state.particles), energy, 0.01 * energy);
  EXPECT_GT(state.tally.wall_hits, 200);
}

TEST(SceneSoftSpheres, SphereRestsInACornerOfWalls) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.01})});
  State state = test::empty_state(true);
  test::add(state, {0.6e-3, 0.6e-3, 0.6e-3}, {});
  auto settings = test::soft_spheres({.restitution = 0.5, .friction = 0.3, .stiffness = 1e3});
  settings.walls.kind = Walls::dem;
  const auto mover = make_mover(domain, settings);
  for (auto& push : state.push) push.assign(1, -9.81);
  test::run(*mover, state, 1e-3, 200);
  // Weight over stiffness: each wall carries its share.
  const double sunk = state.particles.mass[0] * 9.81 / 1e3;
  for (const auto& x : state.particles.place) EXPECT_NEAR(x[0], 0.5e-3 - sunk, 0.02 * sunk + 2e-9);
}

TEST(SceneSoftSpheres, SlidingSphereEndsRolling) {
  // 2/7 of the speed goes, whatever the friction (MFiX DEM04).
  const Domain domain({test::box({0, 0, 0}, {10, 1, 1})});
  const double d = 2e-3, u = 0.5;
  State state = test::empty_state(true);
  const ContactLaw law{.restitution = 0.5, .friction = 0.3, .stiffness = 1e3};
  const double sunk = particle::sphere_mass(d, 1000) * 9.81 / law.stiffness;
  test::add(state, {0.01, 0.5, d / 2 - sunk}, {u, 0, 0}, d);
  auto settings = test::soft_spheres(law);
  settings.walls.kind = Walls::dem;
  const auto mover = make_mover(domain, settings);
  state.push = {std::vector{0.0}, std::vector{0.0}, std::vector{-9.81}};
  test::run(*mover, state, 1e-3, 150);
  EXPECT_NEAR(state.particles.velocity[0][0] / u, 5.0 / 7, 2e-3);
  EXPECT_NEAR(state.particles.spin[1][0] * d / 2 / u, 5.0 / 7, 2e-3);
}

TEST(SceneSoftSpheres, ThreadsGiveTheSameBits) {
  const double edge = 0.03;
  const Domain domain({test::box({}, {edge, edge, edge})});
  State one = test::cloud(4000, edge, 1e-3, 1, 1, true), three = one;
  const ContactLaw law{.restitution = 0.8, .friction = 0.3, .stiffness = 1e4};
  auto settings = test::soft_spheres(law, 1);
  settings.walls.kind = Walls::dem;
  test::run(*make_mover(domain, settings), one, 1e-3, 2);
  settings.n_threads = 3;
  test::run(*make_mover(domain, settings), three, 1e-3, 2);

  test::expect_same_bits(one.particles, three.particles);
}

TEST(SceneSoftSpheres, CountsAsManyCollisionsAsHardSpheres) {
  const double edge = 0.03;
  const Domain domain = test::periodic_cube(edge);
  State soft = test::cloud(1500, edge, 1e-3, 1), hard = soft;
  test::run(*make_mover(domain, test::soft_spheres({.restitution = 0.9, .stiffness = 3e5})), soft, 1e-3, 5);
  test::run(*make_mover(domain, test::hard_spheres(0.9)), hard, 1e-3, 5);

  const auto n = static_cast<double>(hard.tally.collisions);
  EXPECT_GT(n, 1000);
  EXPECT_NEAR(static_cast<double>(soft.tally.collisions), n, 0.05 * n);
  EXPECT_NEAR(kinetic_energy_of(soft.particles), kinetic_energy_of(hard.particles),
              0.02 * kinetic_energy_of(hard.particles));
}

}  // namespace
}  // namespace elrom::scene
