#include "walls.hpp"

#include <algorithm>

#include "elrom/base/parallel.hpp"

namespace elrom::scene {
namespace {

// Few spheres meet a wall: a block takes more of them than elsewhere.
constexpr std::size_t wall_block_size = 4096;

constexpr int most_hits = 1000;  // of a sphere in a step: what is squeezed into a corner stays there

struct Count {
  std::vector<std::int64_t> hits;  // by group
  std::vector<std::int32_t> left;
};

}  // namespace

Path follow(const Domain& domain, const WallLaw& law, const Vec& place, const Vec& velocity, double radius,
            double time) {
  Path path{place, velocity};
  while (path.hits < most_hits) {
    const auto exit = domain.first_exit(path.place, path.velocity, radius, time);
    if (exit.side == nullptr) break;
    path.place += exit.time * path.velocity;
    time -= exit.time;
    if (exit.side->kind == SideKind::outlet) {
      path.left = true;
      break;
    }
    path.velocity = reflected(path.velocity, *exit.side, law);
    ++path.hits;
  }
  if (path.hits < most_hits) path.place += time * path.velocity;
  return path;
}

void fly(State& state, const Domain& domain, const WallLaw& law, double dt, int n_threads) {
  auto& p = state.particles;
  const std::size_t n_blocks = (p.size() + wall_block_size - 1) / wall_block_size;
  std::vector<Count> counts(n_blocks);
  base::parallel_for(n_blocks, n_threads, [&](std::size_t block, int) {
    counts[block].hits.assign(state.tally.wall_hits_by_group.size(), 0);
    for (std::size_t i = block * wall_block_size; i < std::min(p.size(), (block + 1) * wall_block_size);
         ++i) {
      const auto path = follow(domain, law, get(p.place, i), get(p.velocity, i), 0.5 * p.diameter[i], dt);
      set(p.place, i, path.place);
      set(p.velocity, i, path.velocity);
      counts[block].hits[static_cast<std::size_t>(p.group[i])] += path.hits;
      if (path.left) counts[block].left.push_back(static_cast<std::int32_t>(i));
    }
  });
  for (const auto& count : counts) {
    for (std::size_t g = 0; g < count.hits.size(); ++g) state.count_wall_hits(g, count.hits[g]);
    state.leaving.insert(state.leaving.end(), count.left.begin(), count.left.end());
  }
}

}  // namespace elrom::scene
