#include "elrom/scene/neighbours.hpp"

#include "spheres_for_tests.hpp"

namespace elrom::scene {
namespace {

using Found = std::vector<std::pair<std::size_t, std::int32_t>>;

Found pairs_of(const NeighbourList& list, std::size_t n) {
  Found found;
  for (std::size_t i = 0; i < n; ++i)
    for (const auto j : list.above(i)) found.emplace_back(i, j);
  return found;
}

Found by_trying_all(const Particles& p, const Domain& domain, double skin) {
  Found found;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (std::size_t j = i + 1; j < p.size(); ++j) {
      const Vec d = domain.images().nearest(get(p.place, j) - get(p.place, i));
      if (std::sqrt(dot(d, d)) < 0.5 * (p.diameter[i] + p.diameter[j]) + skin)
        found.emplace_back(i, static_cast<std::int32_t>(j));
    }
  return found;
}

void expect_all_found(const State& state, const Domain& domain, double skin) {
  NeighbourList list;
  list.build(state.particles, domain, skin, 1);
  const auto expected = by_trying_all(state.particles, domain, skin);
  EXPECT_EQ(pairs_of(list, state.particles.size()), expected);
  EXPECT_GT(expected.size(), 0u);
}

TEST(SceneNeighbours, FindsEveryPairInTheOpenAndAcrossPeriods) {
  const auto state = test::cloud(800, 0.02, 1e-3, 1);
  for (const double skin : {1e-5, 4e-4, 3e-3}) {
    expect_all_found(state, Domain(), skin);
    expect_all_found(state, test::periodic_cube(0.02), skin);
  }
}

TEST(SceneNeighbours, FindsEveryPairOfSizesThatDifferHundredfold) {
  State state = test::empty_state();
  base::Random random{base::Seed(3)};
  for (int k = 0; k < 1500; ++k)
    test::add(state, {random.uniform(0, 0.02), random.uniform(0, 0.02), random.uniform(0, 0.02)}, {},
              50e-6 * std::pow(100.0, std::pow(random.uniform(), 4)));
  expect_all_found(state, Domain(), 1e-4);
  expect_all_found(state, test::periodic_cube(0.02), 1e-4);
}

TEST(SceneNeighbours, FindsPairsFarFromAllOthers) {
  State state = test::cloud(100, 0.01, 1e-3, 1);
  test::add(state, {1e3, -2e3, 5}, {});
  test::add(state, {1e3, -2e3, 5.0005}, {});
  expect_all_found(state, Domain(), 1e-4);
}

TEST(SceneNeighbours, BothDirectionsHoldTheSamePairs) {
  const auto state = test::cloud(500, 0.015, 1e-3, 1);
  NeighbourList list;
  list.build(state.particles, Domain(), 5e-4, 1);

  Found from_below;
  for (std::size_t j = 0; j < 500; ++j) {
    EXPECT_TRUE(std::ranges::is_sorted(list.above(j)));
    for (const auto i : list.below(j)) from_below.emplace_back(i, j);
  }
  std::ranges::sort(from_below);
  EXPECT_EQ(from_below, pairs_of(list, 500));
}

TEST(SceneNeighbours, DoNotDependOnThreads) {
  const auto state = test::cloud(4000, 0.04, 1e-3, 1);
  NeighbourList one, four;
  one.build(state.particles, Domain(), 5e-4, 1);
  four.build(state.particles, Domain(), 5e-4, 4);
  EXPECT_EQ(pairs_of(one, 4000), pairs_of(four, 4000));
}

TEST(SceneNeighbours, NamesSpheresNearWalls) {
  State state = test::empty_state();
  test::add(state, {0.0006, 0.05, 0.05}, {});
  test::add(state, {0.05, 0.05, 0.05}, {});
  NeighbourList list;
  list.build(state.particles, Domain({test::box({}, {0.1, 0.1, 0.1})}), 2e-4, 1);
  EXPECT_THAT(list.near_wall(), testing::ElementsAre(0));
}

TEST(SceneNeighbours, CountsOverlaps) {
  State state = test::empty_state();
  test::add(state, {0, 0, 0}, {});
  test::add(state, {0.9e-3, 0, 0}, {});
  test::add(state, {1.895e-3, 0, 0}, {});

  const auto overlaps = overlaps_of(state.particles, Domain(), 0.01, 1);

  EXPECT_EQ(overlaps.n, 1u);
  EXPECT_EQ(overlaps.j, 1);
}

}  // namespace
}  // namespace elrom::scene
