// Model hel: cells never pass their packing, momentum stays, energy falls, a bed comes to rest.
#include "elrom/scene/simulation.hpp"
#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

MoverSettings stressed(const Domain& domain, double cell) {
  MoverSettings settings;
  settings.collisions = Collisions::hel;
  settings.grid = std::make_shared<CellGrid>(domain, Vec{cell, cell, cell});
  return settings;
}

// Parcels of 20 spheres of 315 um in a part of a box.
State parcels(std::size_t n, const Vec& low, const Vec& high, std::uint64_t seed = 1) {
  State state = test::empty_state();
  state.particles.are_parcels = true;
  base::Random random{base::Seed(seed)};
  for (std::size_t k = 0; k < n; ++k)
    state.particles.add(
        {{random.uniform(low.x, high.x), random.uniform(low.y, high.y), random.uniform(low.z, high.z)},
         {},
         315e-6,
         1000,
         state.next_id++,
         0,
         20});
  return state;
}

double densest(const State& state, const CellGrid& grid) {
  std::vector<double> volume(grid.size());
  for (std::size_t i = 0; i < state.particles.size(); ++i)
    volume[grid.cell_at(get(state.particles.place, i))] += state.particles.volume(i);
  double most = 0;
  for (std::size_t c = 0; c < grid.size(); ++c)
    if (grid.is_open(c)) most = std::max(most, volume[c] / grid.space(c));
  return most;
}

TEST(SceneStressedParcels, SettleIntoABedThatIsNowhereOverPacked) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.04})});
  for (const double step : {5e-4, 1e-3, 1e-2}) {
    auto settings = stressed(domain, 0.0025);
    settings.walls = {.normal_restitution = 0.8, .tangential_restitution = 0.8};
    const auto mover = make_mover(domain, settings);
    State state = parcels(2000, {}, {0.01, 0.01, 0.035});
    for (auto& component : state.push) component.assign(2000, 0);
    std::ranges::fill(state.push[2], -9.81);
    const double start = densest(state, *settings.grid);
    ASSERT_LT(start, 0.6);
    bool kept_out = false;
    for (double t = 0; t < 0.3; t += step) {
      test::run(*mover, state, step, 1);
      EXPECT_LE(densest(state, *settings.grid), 0.63 + 1e-12);
      kept_out = kept_out || !mover->text().starts_with("0 parcels");
    }
    EXPECT_TRUE(kept_out) << step;
    // 2000 parcels of 20 spheres at 0.6 fill 10.9 mm.
    double height = 0, energy = kinetic_energy_of(state.particles) / mass_of(state.particles);
    for (const double z : state.particles.place[2]) height += z / 2000;
    // Within a cell they may lie low.
    EXPECT_GT(height, 0.5 * 2000 * 20 * particle::sphere_mass(315e-6, 1) / 1e-4 / 0.63 * 0.94) << step;
    EXPECT_LT(height, 0.012) << step;
    EXPECT_LT(energy, 0.02) << step;
  }
}

TEST(SceneStressedParcels, StreamsThatMeetTurnEachOtherAndKeepMomentum) {
  const double edge = 0.02;
  const Domain domain = test::periodic_cube(edge);
  State state = parcels(4000, {}, {0.008, edge, edge});
  const State other = parcels(4000, {0.012, 0, 0}, {edge, edge, edge}, 2);
  for (std::size_t i = 0; i < 4000; ++i) {
    auto sphere = other.particles.sphere(i);
    sphere.id = state.next_id++, sphere.velocity = {-1, 0, 0};
    state.particles.velocity[0][i] = 1.5;
    state.particles.add(sphere);
  }
  const auto mover = make_mover(domain, stressed(domain, 0.0025));
  const Vec before = momentum_of(state.particles);
  const double start = kinetic_energy_of(state.particles);
  double energy = start;
  for (int k = 0; k < 100; ++k) {
    test::run(*mover, state, 2e-4, 1);
    const double now = kinetic_energy_of(state.particles);
    EXPECT_LE(now, energy + 1e-3 * start);
    energy = now;
  }
  const Vec after = momentum_of(state.particles);
  EXPECT_NEAR(after.x, before.x, 1e-12 * mass_of(state.particles));
  EXPECT_NEAR(after.z, before.z, 1e-12 * mass_of(state.particles));
  EXPECT_LT(energy, 0.5 * start);
}

TEST(SceneStressedParcels, OneAloneFliesStraight) {
  const Domain domain = test::periodic_cube(0.02);
  State state = parcels(1, {}, {0.02, 0.02, 0.02});
  set(state.particles.velocity, 0, {1, 2, 3});
  test::run(*make_mover(domain, stressed(domain, 0.0025)), state, 1e-3, 10);
  EXPECT_NEAR(state.particles.velocity[0][0], 1, 1e-6);
  EXPECT_NEAR(state.particles.velocity[2][0], 3, 1e-6);
}

TEST(SceneStressedParcels, NothingIsNoMistake) {
  const Domain domain = test::periodic_cube(0.02);
  State state = test::empty_state();
  test::run(*make_mover(domain, stressed(domain, 0.005)), state, 1e-2, 2);
  EXPECT_EQ(state.particles.size(), 0u);
}

// The cross section of w spheres: parcels collide as often as each of their spheres would.
TEST(SceneParcels, CollideAsOftenAsTheirSpheres) {
  const double edge = 0.02;
  const Domain domain = test::periodic_cube(edge);
  State spheres = test::cloud(4000, edge, 3e-4, 1), groups = test::empty_state();
  groups.particles.are_parcels = true;
  for (std::size_t i = 0; i < 1000; ++i) {
    auto sphere = spheres.particles.sphere(4 * i);
    sphere.weight = 4;
    groups.particles.add(sphere);
  }
  groups.next_id = 4000;
  EXPECT_NEAR(mass_of(groups.particles), mass_of(spheres.particles), 1e-12 * mass_of(spheres.particles));
  // After a time in which those that overlapped as parcels have parted.
  test::run(*make_mover(domain, test::hard_spheres(0.9)), groups, 1e-3, 1);
  const auto at_start = groups.tally.collisions;
  test::run(*make_mover(domain, test::hard_spheres(0.9)), spheres, 1e-3, 1);
  const auto spheres_at_start = spheres.tally.collisions;
  test::run(*make_mover(domain, test::hard_spheres(0.9)), groups, 5e-3, 1);
  test::run(*make_mover(domain, test::hard_spheres(0.9)), spheres, 5e-3, 1);
  const double each = 2.0 * static_cast<double>(spheres.tally.collisions - spheres_at_start) / 4000;
  const double of_parcels = 2.0 * static_cast<double>(groups.tally.collisions - at_start) / 1000;
  EXPECT_NEAR(of_parcels, each, 0.12 * each);
}

}  // namespace
}  // namespace elrom::scene
