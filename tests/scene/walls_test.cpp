// A wall hit is the beginning of a contact, by every collision model and step: hand values.
#include <fmt/format.h>

#include "elrom/scene/simulation.hpp"
#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

struct Case {
  std::string collisions, walls = "reflect";
  double step = 1e-4;
};

std::ostream& operator<<(std::ostream& out, const Case& c) {
  return out << c.collisions << ", walls " << c.walls << ", step " << c.step;
}

const std::vector<Case> cases{{"none"},
                              {"none", "reflect", 1e-3},
                              {"dem"},
                              {"dem", "dem"},
                              {"helscm"},
                              {"helscm", "reflect", 1e-3},
                              {"helscm", "reflect", 1e-5},
                              {"helscm_document"}};

// One sphere of 1 mm in a cube of 10 mm.
std::unique_ptr<Simulation> sphere_in_a_cube(const Case& c, double restitution, const Vec& gravity,
                                             const Vec& place, const Vec& velocity, double duration) {
  const auto list = [](const Vec& v, double less = 0) {
    return fmt::format("[{}, {}, {}]", v.x - less, v.y - less, v.z - less);
  };
  const auto e = fmt::format("{}", restitution);
  auto scene = parse_scene(
      fmt::format("[scene]\nduration = {}\ntime_step = {}\n", duration, c.step) +
          "[effects]\ncollisions = \"" + c.collisions + "\"\nwalls = \"" + c.walls +
          "\"\ngravity = " + list(gravity) + "\n[walls]\nnormal_restitution = " + e +
          "\n[collisions]\nstiffness = 2000\n" + "restitution = " + (restitution > 0 ? e : "0.01") +
          "\n[[domain.boxes]]\nname = \"box\"\nlow = [0, 0, 0]\nhigh = [0.01, 0.01, 0.01]\n"
          "[[regions]]\nname = \"place\"\nlow = " +
          list(place, 0.5005e-3) + "\nhigh = " + list(place, -0.5005e-3) +
          "\n[[particles]]\ngroup = \"a\"\nregion = \"place\"\ndiameter = 1e-3\narrangement = \"lattice\"\n"
          "number = 1\nvelocity = " +
          list(velocity),
      "walls_test");
  return std::make_unique<Simulation>(scene, 1);
}

std::int64_t hits_of(Simulation& simulation) {
  while (!simulation.done()) simulation.step();
  EXPECT_EQ(simulation.state().tally.wall_hits, simulation.state().tally.wall_hits_by_group[0]);
  return simulation.state().tally.wall_hits;
}

TEST(SceneWalls, SphereThatStaysOnTheFloorHitsItOnce) {
  for (const auto& c : cases) {
    const auto s = sphere_in_a_cube(c, 0, {0, 0, -9.81}, {5e-3, 5e-3, 1.5e-3}, {}, 0.1);
    EXPECT_EQ(hits_of(*s), 1) << c;
  }
}

TEST(SceneWalls, SpherePressedIntoACornerHitsThreeWalls) {
  for (const auto& c : cases) {
    const auto s = sphere_in_a_cube(c, 0, {-7, -8, -9}, {1.2e-3, 1e-3, 1.5e-3}, {}, 0.1);
    EXPECT_EQ(hits_of(*s), 3) << c;
  }
}

TEST(SceneWalls, SphereThatFliesToAndFroHitsAWallEachTime) {
  // 9 mm at 3 m/s: after 1.5 ms, then every 3 ms.
  for (const auto& c : cases) {
    const auto s = sphere_in_a_cube(c, 1, {}, {5e-3, 5e-3, 5e-3}, {3, 0, 0}, 0.1);
    EXPECT_EQ(hits_of(*s), 33) << c;
  }
}

TEST(SceneWalls, BouncesCountAsLongAsTheyLeaveTheWall) {
  // From 4 mm with e = 1/2 they rise by 1000, 250, 62, 16 and 3.9 um: four by more than a hundredth of 1 mm.
  for (const auto& c : cases) {
    if (c.step > 1e-4) continue;  // the last bounces take a millisecond
    const auto s = sphere_in_a_cube(c, 0.5, {0, 0, -9.81}, {5e-3, 5e-3, 4.5e-3}, {}, 0.2);
    EXPECT_EQ(hits_of(*s), 5) << c;
  }
}

TEST(SceneWalls, SphereThatAnotherPressesOnAWallHitsItOnce) {
  const Domain domain({test::box({}, {0.01, 0.01, 0.01})});
  for (const bool soft : {false, true}) {
    State state = test::empty_state();
    state.particles.remembers_walls = true;
    test::add(state, {0.5e-3, 5e-3, 5e-3}, {});
    test::add(state, {1.6e-3, 5e-3, 5e-3}, {-1, 0, 0});
    const auto settings =
        soft ? test::soft_spheres({.restitution = 0.9, .stiffness = 1e4}) : test::hard_spheres(0.9);
    test::run(*make_mover(domain, settings), state, 1e-3, 1);
    EXPECT_EQ(state.tally.wall_hits, 1) << soft;
    EXPECT_GT(state.particles.velocity[0][1], 0) << soft;
  }
}

TEST(SceneWalls, WhatIsTouchedIsKeptWithTheRun) {
  const Case c{"helscm"};
  auto s = sphere_in_a_cube(c, 0, {0, 0, -9.81}, {5e-3, 5e-3, 0.6e-3}, {}, 0.1);
  for (int k = 0; k < 500; ++k) s->step();
  const auto saved = s->save();
  const auto again = sphere_in_a_cube(c, 0, {0, 0, -9.81}, {5e-3, 5e-3, 0.6e-3}, {}, 0.1);
  again->load(saved);
  EXPECT_EQ(hits_of(*again), 1);
}

TEST(SceneWalls, ContactOfSoftSpheresCountsOnceWhileItLasts) {
  const Domain everywhere;
  State state = test::empty_state();
  test::add(state, {-0.5e-3, 0, 0}, {});
  test::add(state, {0.5e-3, 0, 0}, {});
  state.push = {std::vector{10.0, -10.0}, std::vector{0.0, 0.0}, std::vector{0.0, 0.0}};
  const auto mover = make_mover(everywhere, test::soft_spheres({.restitution = 0.05, .stiffness = 1e4}));
  for (int k = 0; k < 50; ++k) {
    test::run(*mover, state, 1e-3, 1);
    mover->forget();
  }
  EXPECT_EQ(state.tally.collisions, 1);
}

}  // namespace
}  // namespace elrom::scene
