// Sums over spheres against values by hand.
#include "elrom/scene/particles.hpp"

#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

// Mass pi/6 d^3 rho: 1 kg. Moment of inertia m d^2 / 10.
TEST(SceneParticles, SpinsHaveEnergyToo) {
  State state = test::empty_state(true);
  const double diameter = 0.2, density = 6 / (test::pi * diameter * diameter * diameter);
  test::add(state, {}, {3, 0, 4}, diameter, density);

  EXPECT_NEAR(mass_of(state.particles), 1, 1e-12);
  EXPECT_NEAR(kinetic_energy_of(state.particles), 12.5, 1e-12);
  set(state.particles.spin, 0, {0, 10, 0});
  EXPECT_NEAR(kinetic_energy_of(state.particles), 12.5 + 0.5 * 0.004 * 100, 1e-12);
  EXPECT_NEAR(greatest_speed_of(state.particles), 5, 1e-12);
}

TEST(SceneParticles, ThoseThatStayKeepTheirOrderAndAllTheyHave) {
  State state = test::empty_state(true);
  for (const double x : {1.0, 2.0, 3.0, 4.0}) test::add(state, {x, 0, 0}, {0, x, 0}, 1e-3 * x, 1000 * x);
  set(state.particles.spin, 3, {7, 8, 9});

  state.particles.keep_only({0, 1, 0, 1});

  ASSERT_EQ(state.particles.size(), 2u);
  EXPECT_EQ(state.particles.id, (std::vector<std::int64_t>{1, 3}));
  EXPECT_EQ(get(state.particles.place, 1), (Vec{4, 0, 0}));
  EXPECT_EQ(get(state.particles.velocity, 0), (Vec{0, 2, 0}));
  EXPECT_EQ(get(state.particles.spin, 1), (Vec{7, 8, 9}));
  EXPECT_EQ(state.particles.diameter, (std::vector{2e-3, 4e-3}));
  EXPECT_NEAR(state.particles.mass[1], test::pi / 6 * 64e-9 * 4000, 1e-18);
}

}  // namespace
}  // namespace elrom::scene
