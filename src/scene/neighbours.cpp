#include "elrom/scene/neighbours.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"

namespace elrom::scene {
namespace {

constexpr std::size_t block_size = 1024;  // spheres a thread takes at a time
using Cell = std::array<std::int64_t, 3>;

// Spheres of about one size, sorted by cells. Cells lie in a dense table where it is not much larger than the
// spheres' number, else cells share the table's places by a hash.
class Level {
 public:
  Level(const Particles& p, const Domain& domain, std::vector<std::int32_t> members, double skin)
      : members_(std::move(members)) {
    for (const auto i : members_) radius_ = std::max(radius_, 0.5 * p.diameter[static_cast<std::size_t>(i)]);
    place_grid(p, domain, 2 * radius_ + skin);
    sort(p, domain);
  }
  [[nodiscard]] double radius() const { return radius_; }

  // Calls found(j, sorted place) for each sphere in cells within `reach` of a place.
  template <class Found>
  void near(const Vec& place, double reach, const Found& found) const {
    const std::array<double, 3> at{place.x, place.y, place.z};
    Cell from, to;
    for (std::size_t a = 0; a < 3; ++a) {
      from[a] = cell_along(at[a] - reach, a);
      to[a] = cell_along(at[a] + reach, a);
      if (period_[a] && to[a] - from[a] >= count_[a]) from[a] = 0, to[a] = count_[a] - 1;
      if (!period_[a]) from[a] = std::max<std::int64_t>(from[a], 0), to[a] = std::min(to[a], count_[a] - 1);
    }
    for (std::int64_t z = from[2]; z <= to[2]; ++z)
      for (std::int64_t y = from[1]; y <= to[1]; ++y) near_row(from[0], to[0], y, z, found);
  }

 private:
  template <class Found>
  void near_row(std::int64_t x0, std::int64_t x1, std::int64_t y, std::int64_t z, const Found& found) const {
    if (x0 > x1) return;
    const auto row = [&](std::int64_t first, std::int64_t last) {
      if (dense_) return run(bucket(key({first, y, z})), bucket(key({last, y, z})) + 1, found);
      for (std::int64_t x = first; x <= last; ++x) run_of_cell(key({x, y, z}), found);
    };
    if (!period_[0] || (x0 >= 0 && x1 < count_[0])) return row(x0, x1);
    for (std::int64_t x = x0; x <= x1; ++x) row(x, x);
  }
  template <class Found>
  void run(std::size_t first, std::size_t last, const Found& found) const {
    for (std::size_t k = begin_[first]; k < begin_[last]; ++k) found(members_[k], k);
  }
  template <class Found>
  void run_of_cell(std::int64_t key, const Found& found) const {
    const auto at = bucket(key);
    for (std::size_t k = begin_[at]; k < begin_[at + 1]; ++k)
      if (keys_[k] == key) found(members_[k], k);
  }

  void place_grid(const Particles& p, const Domain& domain, double size) {
    const Vec period = domain.images().period;
    const std::array<double, 3> lengths{period.x, period.y, period.z};
    for (std::size_t a = 0; a < 3; ++a) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const auto i : members_) {
        const double x = p.place[a][static_cast<std::size_t>(i)];
        low = std::min(low, x), high = std::max(high, x);
      }
      period_[a] = lengths[a] > 0;
      origin_[a] = low;
      const double extent = period_[a] ? lengths[a] : high - low;
      count_[a] = static_cast<std::int64_t>(std::clamp(std::floor(extent / size), 1.0, 2e6));
      per_length_[a] = static_cast<double>(count_[a]) / std::max(extent, size);
      if (!period_[a]) per_length_[a] = std::min(per_length_[a], 1 / size);
    }
    const double n_cells =
        static_cast<double>(count_[0]) * static_cast<double>(count_[1]) * static_cast<double>(count_[2]);
    dense_ = n_cells <= 8.0 * static_cast<double>(members_.size()) + 4096;
    n_buckets_ = dense_ ? static_cast<std::size_t>(n_cells) : 1;
    while (!dense_ && n_buckets_ < 2 * members_.size()) n_buckets_ *= 2;
  }

  [[nodiscard]] std::int64_t cell_along(double x, std::size_t a) const {
    return static_cast<std::int64_t>(std::clamp(std::floor((x - origin_[a]) * per_length_[a]), -4e6, 4e6));
  }
  [[nodiscard]] std::int64_t key(Cell cell) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (period_[a]) cell[a] = (cell[a] % count_[a] + count_[a]) % count_[a];
      cell[a] = std::clamp<std::int64_t>(cell[a], 0, count_[a] - 1);
    }
    return cell[0] + count_[0] * (cell[1] + count_[1] * cell[2]);
  }
  [[nodiscard]] std::size_t bucket(std::int64_t key) const {
    if (dense_) return static_cast<std::size_t>(key);
    const auto mixed = static_cast<std::uint64_t>(key) * 0x9E3779B97F4A7C15ull;
    return (mixed >> 20) & (n_buckets_ - 1);
  }

  void sort(const Particles& p, const Domain&) {
    std::vector<std::int64_t> keys;
    begin_.assign(n_buckets_ + 1, 0);
    for (const auto i : members_) {
      const auto at = static_cast<std::size_t>(i);
      Cell cell;
      for (std::size_t a = 0; a < 3; ++a) cell[a] = cell_along(p.place[a][at], a);
      keys.push_back(key(cell));
      ++begin_[bucket(keys.back()) + 1];
    }
    for (std::size_t b = 0; b < n_buckets_; ++b) begin_[b + 1] += begin_[b];
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    std::vector<std::int32_t> sorted(members_.size());
    keys_.resize(members_.size());
    for (std::size_t k = 0; k < members_.size(); ++k) {
      const auto at = next[bucket(keys[k])]++;
      sorted[at] = members_[k];
      keys_[at] = keys[k];
    }
    members_ = std::move(sorted);
  }

  std::vector<std::int32_t> members_;  // sorted by bucket, then by number
  std::vector<std::int64_t> keys_;     // of their cells
  std::vector<std::size_t> begin_;     // of each bucket
  std::array<double, 3> origin_{}, per_length_{};
  Cell count_{};
  std::array<bool, 3> period_{};
  std::size_t n_buckets_ = 1;
  bool dense_ = true;
  double radius_ = 0;
};

// How many times smaller than the largest, in factors of two.
std::size_t level_of(double diameter, double largest) {
  return static_cast<std::size_t>(std::max(0.0, std::floor(std::log2(largest / diameter))));
}

struct Levels {
  std::vector<Level> levels;     // largest spheres first
  std::vector<std::uint8_t> of;  // of each sphere: its place in `levels`

  Levels(const Particles& p, const Domain& domain, double skin) : of(p.size()) {
    const double largest = *std::max_element(p.diameter.begin(), p.diameter.end());
    std::vector<std::vector<std::int32_t>> members;
    std::vector<std::size_t> level(p.size());
    for (std::size_t i = 0; i < p.size(); ++i) {
      level[i] = level_of(p.diameter[i], largest);
      if (members.size() <= level[i]) members.resize(level[i] + 1);
      members[level[i]].push_back(static_cast<std::int32_t>(i));
    }
    std::vector<std::uint8_t> filled(members.size());
    for (std::size_t k = 0; k < members.size(); ++k) {
      filled[k] = static_cast<std::uint8_t>(levels.size());
      if (!members[k].empty()) levels.emplace_back(p, domain, std::move(members[k]), skin);
    }
    for (std::size_t i = 0; i < p.size(); ++i) of[i] = filled[level[i]];
  }
};

using Pairs = std::vector<std::array<std::int32_t, 2>>;

// Pairs of one sphere with those of its own level and of larger ones.
void pairs_of(const Particles& p, const Images& images, const Levels& levels, std::size_t i, double skin,
              Pairs& pairs) {
  const bool periodic = images.any();
  const Vec place = get(p.place, i);
  const double radius = 0.5 * p.diameter[i] + skin;
  const double *x = p.place[0].data(), *y = p.place[1].data(), *z = p.place[2].data(), *d = p.diameter.data();
  const auto me = static_cast<std::int32_t>(i);
  for (std::size_t level = 0; level <= levels.of[i]; ++level) {
    const bool own = level == levels.of[i];
    levels.levels[level].near(place, radius + levels.levels[level].radius(),
                              [&](std::int32_t j, std::size_t) {
                                if (own && j <= me) return;
                                const auto at = static_cast<std::size_t>(j);
                                Vec apart{x[at] - place.x, y[at] - place.y, z[at] - place.z};
                                if (periodic) apart = images.nearest(apart);
                                const double limit = radius + 0.5 * d[at];
                                if (dot(apart, apart) < limit * limit)
                                  pairs.push_back({std::min(me, j), std::max(me, j)});
                              });
  }
}

void expect_finite(const Particles& p) {
  for (std::size_t i = 0; i < p.size(); ++i)
    if (!(std::abs(p.place[0][i]) + std::abs(p.place[1][i]) + std::abs(p.place[2][i]) < HUGE_VAL))
      throw NumericalError(Problem{.what = fmt::format("sphere {} is nowhere", p.id[i]),
                                   .advice = "take a shorter time step"});
}

}  // namespace

void NeighbourList::build(const Particles& p, const Domain& domain, double skin, int n_threads) {
  const std::size_t n = p.size(), n_blocks = (n + block_size - 1) / block_size;
  above_.begin.assign(n + 1, 0);
  above_.partner.clear();
  all_ = {};
  near_wall_.clear();
  if (n == 0) return;
  expect_finite(p);
  const Levels levels(p, domain, skin);
  std::vector<Pairs> found(n_blocks);
  std::vector<std::vector<std::int32_t>> walls(n_blocks);
  base::parallel_for(n_blocks, n_threads, [&](std::size_t block, int) {
    for (std::size_t i = block * block_size; i < std::min(n, (block + 1) * block_size); ++i) {
      pairs_of(p, domain.images(), levels, i, skin, found[block]);
      if (!domain.unbounded() && domain.room(get(p.place, i)) < 0.5 * p.diameter[i] + skin)
        walls[block].push_back(static_cast<std::int32_t>(i));
    }
  });
  for (const auto& pairs : found)
    for (const auto& pair : pairs) ++above_.begin[static_cast<std::size_t>(pair[0]) + 1];
  for (std::size_t i = 0; i < n; ++i) above_.begin[i + 1] += above_.begin[i];
  above_.partner.resize(above_.begin[n]);
  std::vector<std::size_t> next(above_.begin.begin(), above_.begin.end() - 1);
  for (const auto& pairs : found)
    for (const auto& pair : pairs) above_.partner[next[static_cast<std::size_t>(pair[0])]++] = pair[1];
  for (std::size_t i = 0; i < n; ++i)
    std::sort(above_.partner.begin() + static_cast<std::ptrdiff_t>(above_.begin[i]),
              above_.partner.begin() + static_cast<std::ptrdiff_t>(above_.begin[i + 1]));
  for (const auto& wall : walls) near_wall_.insert(near_wall_.end(), wall.begin(), wall.end());
}

void NeighbourList::with_both() {
  const std::size_t n = above_.begin.size() - 1;
  all_.begin.assign(n + 1, 0);
  for (std::size_t i = 0; i < n; ++i) {
    all_.begin[i + 1] += above(i).size();
    for (const auto j : above(i)) ++all_.begin[static_cast<std::size_t>(j) + 1];
  }
  for (std::size_t i = 0; i < n; ++i) all_.begin[i + 1] += all_.begin[i];
  all_.partner.resize(all_.begin[n]);
  std::vector<std::size_t> next(all_.begin.begin(), all_.begin.end() - 1);
  // Smaller partners of j come in the order of i, before j's own larger ones.
  for (std::size_t i = 0; i < n; ++i)
    for (const auto j : above(i))
      all_.partner[next[static_cast<std::size_t>(j)]++] = static_cast<std::int32_t>(i);
  for (std::size_t i = 0; i < n; ++i)
    for (const auto j : above(i)) all_.partner[next[i]++] = j;
}

std::size_t NeighbourList::bytes() const {
  const auto of = [](const Rows& rows) {
    return rows.begin.capacity() * sizeof(std::size_t) + rows.partner.capacity() * sizeof(std::int32_t);
  };
  return of(above_) + of(all_) + near_wall_.capacity() * sizeof(std::int32_t);
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
