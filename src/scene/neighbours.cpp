#include "elrom/scene/neighbours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "neighbour_level.hpp"

namespace elrom::scene {
namespace {

// How many times smaller than the largest, in factors of two.
std::size_t level_of(double diameter, double largest) {
  return largest < 2 * diameter ? 0 : static_cast<std::size_t>(std::ilogb(largest / diameter));
}

void expect_finite(const Particles& p) {
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!(std::abs(p.place[0][i]) + std::abs(p.place[1][i]) + std::abs(p.place[2][i]) < HUGE_VAL))
      throw NumericalError(Problem{.what = fmt::format("sphere {} is nowhere", p.id[i]),
                                   .advice = "take a shorter time step"});
}

// Spheres around a sphere, by volume: how many others its cell of four diameters holds, on average.
double crowding(const Particles& p, double mean_diameter) {
  const double edge = 4 * mean_diameter;
  std::size_t n_buckets = 1;
  while (n_buckets < 4 * p.size()) n_buckets *= 2;
  std::vector<std::uint32_t> count(n_buckets);
  double pairs = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    std::uint64_t key = 0;
    for (std::size_t a = 0; a < 3; ++a)
      key = (key + static_cast<std::uint64_t>(static_cast<std::int64_t>(
                       std::clamp(std::floor(p.place[a][i] / edge), -1e15, 1e15)))) *
            0x9E3779B97F4A7C15ull;
    pairs += 2 * count[(key >> 24) & (n_buckets - 1)]++;
  }
  return pairs / static_cast<double>(p.size()) / (edge * edge * edge);
}

}  // namespace

// What a search needs, kept from list to list.
struct NeighbourList::Search {
  std::vector<Level> levels;  // largest spheres first; those of some size may be none
  std::vector<Pairs> found;   // by block
  std::vector<std::vector<std::int32_t>> walls;
  std::vector<std::size_t> next;

  void sort_into_levels(const Particles& p, const Domain& domain, double skin) {
    const auto& d = p.contact_diameter();
    const double largest = *std::max_element(d.begin(), d.end());
    for (auto& level : levels) level.members.clear();
    for (std::size_t i = 0; i < p.size(); ++i) {
      const auto level = level_of(d[i], largest);
      if (levels.size() <= level) levels.resize(level + 1);
      levels[level].members.push_back(static_cast<std::int32_t>(i));
    }
    for (auto& level : levels)
      if (!level.members.empty()) level.build(p, domain, skin);
  }

  // Pairs of the spheres at some places of a level with those of their own level and of larger ones.
  void search(const Images& images, std::size_t level, std::size_t first, std::size_t last, double skin,
              Pairs& pairs) const {
    Company company;
    const Level& own = levels[level];
    const auto add = [&](std::int32_t me, std::int32_t other) {
      pairs.push_back({std::min(me, other), std::max(me, other)});
    };
    for (std::size_t k = first; own.has_halves() && k < last;) {
      own.half_around(k, company);
      const std::size_t begin = k, end = own.end_of_cell(k, last);
      for (; k < end; ++k)
        for (const auto other : company.near(own.place(k), own.radius(k) + skin, k - begin + 1))
          add(own.members[k], other);
    }
    for (std::size_t other = own.has_halves() ? level : level + 1; other-- > 0;)
      for (std::size_t k = first; k < last && !levels[other].members.empty(); ++k)
        for (const auto partner : levels[other].near(own.place(k), own.radius(k) + skin, images, company))
          if (other != level || partner > own.members[k]) add(own.members[k], partner);
  }
};

NeighbourList::NeighbourList() : search_(std::make_unique<Search>()) {}
NeighbourList::~NeighbourList() = default;

void NeighbourList::build(const Particles& p, const Domain& domain, double skin, int n_threads) {
  const std::size_t n = p.size();
  for (auto* rows : {&above_, &below_}) rows->begin.assign(n + 1, 0), rows->partner.clear();
  near_wall_.clear();
  if (n == 0) return;
  expect_finite(p);
  auto& s = *search_;
  s.sort_into_levels(p, domain, skin);
  struct Piece {
    std::size_t level, first, last;
  };
  std::vector<Piece> pieces;
  for (std::size_t level = 0; level < s.levels.size(); ++level)
    for (std::size_t first = 0; first < s.levels[level].members.size(); first += block_size)
      pieces.push_back({level, first, std::min(first + block_size, s.levels[level].members.size())});
  if (s.found.size() < pieces.size()) s.found.resize(pieces.size());
  for (auto& pairs : s.found) pairs.clear();
  base::parallel_for(pieces.size(), n_threads, [&](std::size_t k, int) {
    s.search(domain.images(), pieces[k].level, pieces[k].first, pieces[k].last, skin, s.found[k]);
  });
  sort_pairs(n);
  if (!domain.unbounded()) find_walls(p, domain, skin, n_threads);
}

void NeighbourList::find_walls(const Particles& p, const Domain& domain, double skin, int n_threads) {
  const std::size_t n = p.size(), n_blocks = (n + block_size - 1) / block_size;
  auto& walls = search_->walls;
  walls.resize(n_blocks);
  base::parallel_for(n_blocks, n_threads, [&](std::size_t block, int) {
    walls[block].clear();
    for (std::size_t i = block * block_size; i < std::min(n, (block + 1) * block_size); ++i)
      if (domain.room(get(p.place, i)) < 0.5 * p.diameter[i] + skin)
        walls[block].push_back(static_cast<std::int32_t>(i));
  });
  for (const auto& wall : walls) near_wall_.insert(near_wall_.end(), wall.begin(), wall.end());
}

// Counting sorts by the larger number of a pair, then by the smaller: partners above come out ascending.
void NeighbourList::sort_pairs(std::size_t n) {
  auto& s = *search_;
  for (const auto& pairs : s.found)
    for (const auto& [i, j] : pairs) {
      ++above_.begin[static_cast<std::size_t>(i) + 1];
      ++below_.begin[static_cast<std::size_t>(j) + 1];
    }
  for (std::size_t i = 0; i < n; ++i)
    above_.begin[i + 1] += above_.begin[i], below_.begin[i + 1] += below_.begin[i];
  below_.partner.resize(below_.begin[n]);
  s.next.assign(below_.begin.begin(), below_.begin.end() - 1);
  for (const auto& pairs : s.found)
    for (const auto& [i, j] : pairs) below_.partner[s.next[static_cast<std::size_t>(j)]++] = i;
  above_.partner.resize(above_.begin[n]);
  s.next.assign(above_.begin.begin(), above_.begin.end() - 1);
  for (std::size_t j = 0; j < n; ++j)
    for (const auto i : below(j))
      above_.partner[s.next[static_cast<std::size_t>(i)]++] = static_cast<std::int32_t>(j);
}

std::size_t NeighbourList::bytes() const {
  const auto of = [](const Rows& rows) {
    return rows.begin.capacity() * sizeof(std::size_t) + rows.partner.capacity() * sizeof(std::int32_t);
  };
  return of(above_) + of(below_) + near_wall_.capacity() * sizeof(std::int32_t);
}

double best_skin(const Particles& p, double travel, double look) {
  constexpr double make = 2e-7, make_pair = 2e-8;  // s, of a list, for each sphere and each pair
  double mean = 0;
  for (const double d : p.contact_diameter()) mean += d / static_cast<double>(p.size());
  const double around = 2 * std::numbers::pi / 3 * crowding(p, mean);  // pairs of a sphere, by reach cubed
  double best = 0.1 * mean, least = HUGE_VAL;
  for (double skin = best; skin < 60 * mean; skin *= 1.25) {
    const double lists = 2 * travel / skin;  // that a step takes
    const double pairs = around * std::pow(mean + skin, 3);
    const double cost = lists * (make + make_pair * pairs) + std::max(1.0, lists) * look * pairs;
    if (cost < least) least = cost, best = skin;
  }
  return best;
}

Overlaps overlaps_of(const Particles& p, const Domain& domain, double share, int n_threads) {
  NeighbourList list;
  list.build(p, domain, 0, n_threads);
  Overlaps overlaps;
  for (std::size_t i = 0; i < p.size(); ++i)
    for (const auto j : list.above(i)) {
      const auto at = static_cast<std::size_t>(j);
      const Vec apart = domain.images().nearest(get(p.place, at) - get(p.place, i));
      const double overlap = 0.5 * (p.diameter[i] + p.diameter[at]) - std::sqrt(dot(apart, apart));
      if (overlap <= share * std::min(p.diameter[i], p.diameter[at])) continue;
      if (overlaps.n++ == 0) overlaps.i = static_cast<std::int32_t>(i), overlaps.j = j;
    }
  return overlaps;
}

}  // namespace elrom::scene
