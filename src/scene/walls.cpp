#include "walls.hpp"

#include <algorithm>
#include <cmath>

#include "elrom/base/parallel.hpp"

namespace elrom::scene {
namespace {

// Few spheres meet a wall: a block takes more of them than elsewhere.
constexpr std::size_t wall_block_size = 4096;

constexpr int most_turns = 1000;  // of a sphere in a step: what is squeezed into a corner stays there
constexpr double parted = 0.01;   // of the diameter

struct Count {
  std::vector<std::int64_t> hits;  // by group
  std::vector<std::int32_t> left;
};

}  // namespace

double wall_reach(const State& state, std::size_t i, double dt) {
  const double diameter = state.particles.diameter[i];
  double gap = parted * diameter;
  if (!state.push[0].empty()) {
    const Vec push = get(state.push, i);
    gap = std::max(gap, 0.5 * std::sqrt(dot(push, push)) * dt * dt);
  }
  return 0.5 * diameter + gap;
}

Flight flight_of(const State& state, std::size_t i, double dt) {
  const auto& p = state.particles;
  return {get(p.place, i), get(p.velocity, i), 0.5 * p.diameter[i], wall_reach(state, i, dt),
          p.remembers_walls ? p.touched[i] : 0};
}

Path follow(const Domain& domain, const WallLaw& law, const Flight& flight, double time) {
  Path path{flight.place, flight.velocity, flight.touched};
  for (int turns = 0; turns < most_turns; ++turns) {
    const auto exit = domain.first_exit(path.place, path.velocity, flight.radius, time);
    const bool flies_on = exit.side == nullptr;
    path.place += (flies_on ? time : exit.time) * path.velocity;
    path.touched = domain.nearer(path.touched, path.place, flight.reach);
    if (flies_on) break;
    time -= exit.time;
    if (exit.side->kind == SideKind::outlet) {
      path.left = true;
      path.place += time * path.velocity;
      break;
    }
    path.velocity = reflected(path.velocity, *exit.side, law);
    const auto wall = domain.bit(*exit.side);
    path.hits += (path.touched & wall) == 0 ? 1 : 0;
    path.touched |= wall;
  }
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
      const auto path = follow(domain, law, flight_of(state, i, dt), dt);
      set(p.place, i, path.place);
      set(p.velocity, i, path.velocity);
      if (p.remembers_walls) p.touched[i] = path.touched;
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
