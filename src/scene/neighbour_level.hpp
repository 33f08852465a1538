#pragma once
// Spheres of about one size in cells, and who is near whom among them and across to another size. Internal to
// scene.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "elrom/scene/neighbours.hpp"

namespace elrom::scene {

using Cell = std::array<std::int64_t, 3>;
using Pairs = std::vector<std::array<std::int32_t, 2>>;

// Rows of cells after a cell's own that make half of its neighbourhood: {y, z}.
inline constexpr std::array<std::array<std::int64_t, 2>, 4> rows_ahead{{{1, 0}, {-1, 1}, {0, 1}, {1, 1}}};

class Level;

// Spheres that may be near those of a cell, side by side.
struct Company {
  std::size_t size = 0;  // of the arrays, which only grow
  std::vector<double> x, y, z, r, gap;
  std::vector<std::int32_t> number, found;

  void clear() { size = 0; }
  void add(const Level& level, std::size_t first, std::size_t last, const Vec& move);
  // Which of them, from one on, are nearer to a place than their radius and a reach. @return numbers
  std::span<const std::int32_t> near(const Vec& place, double reach, std::size_t from) {
    const std::size_t n = size;
    const double *px = x.data(), *py = y.data(), *pz = z.data(), *pr = r.data();
    double* const out = gap.data();
    for (std::size_t k = from; k < n; ++k) {
      const double dx = px[k] - place.x, dy = py[k] - place.y, dz = pz[k] - place.z, limit = reach + pr[k];
      out[k] = dx * dx + dy * dy + dz * dz - limit * limit;
    }
    std::size_t n_found = 0;
    for (std::size_t k = from; k < n; ++k) {
      found[n_found] = number[k];
      n_found += out[k] < 0 ? 1 : 0;
    }
    return {found.data(), n_found};
  }
};

// Spheres of about one size, sorted by cells. Cells lie in a dense table where it is not much larger than the
// spheres' number, else cells share the table's places by a hash.
class Level {
 public:
  std::vector<std::int32_t> members;  // sorted by bucket, then by number
  friend Company;

  void build(const Particles& p, const Domain& domain, double skin) {
    radius_ = 0;
    for (const auto i : members)
      radius_ = std::max(radius_, 0.5 * p.contact_diameter()[static_cast<std::size_t>(i)]);
    place_grid(p, domain, 2 * radius_ + skin);
    sort(p);
  }
  [[nodiscard]] double radius() const { return radius_; }
  [[nodiscard]] Vec place(std::size_t k) const { return {x_[k], y_[k], z_[k]}; }
  [[nodiscard]] double radius(std::size_t k) const { return r_[k]; }

  // Members of one cell from place k on. @return the place behind the last
  [[nodiscard]] std::size_t end_of_cell(std::size_t k, std::size_t last) const {
    std::size_t end = k + 1;
    while (end < last && keys_[end] == keys_[k]) ++end;
    return end;
  }
  // The cell of place k from there on, and the half of the cells around it. Only where there are halves.
  void half_around(std::size_t k, Company& company) const {
    company.clear();
    const auto at = cell_of_key(keys_[k]);
    const auto rest = bucket(keys_[k]);
    for (std::size_t q = k; q < begin_[rest + 1]; ++q)
      if (keys_[q] == keys_[k]) company.add(*this, q, q + 1, {});
    gather(at[0] + 1, at[0] + 1, at[1], at[2], company);
    for (const auto& [y, z] : rows_ahead) gather(at[0] - 1, at[0] + 1, at[1] + y, at[2] + z, company);
  }
  // Whether half a neighbourhood holds each pair once.
  [[nodiscard]] bool has_halves() const {
    for (std::size_t a = 0; a < 3; ++a)
      if (period_[a] && count_[a] < 3) return false;
    return true;
  }

  // Those nearer to a place than their radius and `reach`.
  std::span<const std::int32_t> near(const Vec& place, double reach, const Images& images,
                                     Company& company) const {
    const double wide = reach + radius_;
    const Vec corner{wide, wide, wide};
    Cell from = cell_of(place - corner), to = cell_of(place + corner);
    for (std::size_t a = 0; a < 3; ++a) {
      if (period_[a] && to[a] - from[a] >= count_[a]) from[a] = 0, to[a] = count_[a] - 1;
      if (!period_[a]) from[a] = std::max<std::int64_t>(from[a], 0), to[a] = std::min(to[a], count_[a] - 1);
    }
    company.clear();
    const auto add = [&](std::size_t first, std::size_t last) {
      for (std::size_t k = first; k < last; ++k) company.add(*this, k, k + 1, image(k, place, images));
    };
    for (std::int64_t z = from[2]; z <= to[2]; ++z)
      for (std::int64_t y = from[1]; y <= to[1]; ++y) row(from[0], to[0], y, z, add);
    return company.near(place, reach, 0);
  }

 private:
  // A row of cells, moved by a period where it lies beyond the ends of one.
  void gather(std::int64_t x0, std::int64_t x1, std::int64_t y, std::int64_t z, Company& company) const {
    Vec move{0, shift(y, 1), shift(z, 2)};
    if (!period_[0] || (x0 >= 0 && x1 < count_[0]))
      return row(x0, x1, y, z,
                 [&](std::size_t first, std::size_t last) { company.add(*this, first, last, move); });
    for (std::int64_t x = x0; x <= x1; ++x) {
      move.x = shift(x, 0);
      row(x, x, y, z, [&](std::size_t first, std::size_t last) { company.add(*this, first, last, move); });
    }
  }
  [[nodiscard]] double shift(std::int64_t index, std::size_t a) const {
    return !period_[a] ? 0 : index < 0 ? -length_[a] : index >= count_[a] ? length_[a] : 0;
  }
  [[nodiscard]] Cell cell_of_key(std::int64_t key) const {
    return {key % count_[0], key / count_[0] % count_[1], key / count_[0] / count_[1]};
  }
  template <class Run>
  void row(std::int64_t x0, std::int64_t x1, std::int64_t y, std::int64_t z, const Run& run) const {
    if (!wrap(y, 1) || !wrap(z, 2)) return;
    const bool inside = x0 >= 0 && x1 < count_[0];
    if (!period_[0]) x0 = std::max<std::int64_t>(x0, 0), x1 = std::min(x1, count_[0] - 1);
    if (dense_ && x0 <= x1 && (inside || !period_[0])) {
      const auto base = static_cast<std::size_t>(count_[0] * (y + count_[1] * z));
      return run(begin_[base + static_cast<std::size_t>(x0)],
                 begin_[base + static_cast<std::size_t>(x1) + 1]);
    }
    for (std::int64_t x = x0; x <= x1; ++x) {
      std::int64_t wrapped = x;
      wrap(wrapped, 0);
      cell(wrapped + count_[0] * (y + count_[1] * z), run);
    }
  }
  template <class Run>
  void cell(std::int64_t key, const Run& run) const {
    const auto at = bucket(key);
    if (dense_) return run(begin_[at], begin_[at + 1]);
    for (std::size_t k = begin_[at]; k < begin_[at + 1]; ++k)
      if (keys_[k] == key) run(k, k + 1);
  }
  // @return whether there is such a row of cells
  bool wrap(std::int64_t& index, std::size_t a) const {
    if (index >= 0 && index < count_[a]) return true;
    if (period_[a]) index = (index % count_[a] + count_[a]) % count_[a];
    return period_[a];
  }

  void place_grid(const Particles& p, const Domain& domain, double size) {
    const auto lengths = array_of(domain.images().period);
    for (std::size_t a = 0; a < 3; ++a) {
      double low = HUGE_VAL, high = -HUGE_VAL;
      for (const auto i : members) {
        const double x = p.place[a][static_cast<std::size_t>(i)];
        low = std::min(low, x), high = std::max(high, x);
      }
      period_[a] = lengths[a] > 0;
      origin_[a] = low, length_[a] = lengths[a];
      const double extent = period_[a] ? lengths[a] : high - low;
      count_[a] = static_cast<std::int64_t>(std::clamp(std::floor(extent / size), 1.0, 2e6));
      per_length_[a] = static_cast<double>(count_[a]) / std::max(extent, size);
      if (!period_[a]) per_length_[a] = std::min(per_length_[a], 1 / size);
    }
    const double n_cells =
        static_cast<double>(count_[0]) * static_cast<double>(count_[1]) * static_cast<double>(count_[2]);
    dense_ = n_cells <= 32.0 * static_cast<double>(members.size()) + 4096;
    n_buckets_ = dense_ ? static_cast<std::size_t>(n_cells) : 1;
    while (!dense_ && n_buckets_ < 2 * members.size()) n_buckets_ *= 2;
  }

  // Not clamped to the table: an index beyond it is a cell that holds nothing, or of a period.
  [[nodiscard]] Cell cell_of(const Vec& p) const {
    const auto at = array_of(p);
    Cell cell;
    for (std::size_t a = 0; a < 3; ++a)
      cell[a] =
          static_cast<std::int64_t>(std::clamp(std::floor((at[a] - origin_[a]) * per_length_[a]), -4e6, 4e6));
    return cell;
  }
  [[nodiscard]] Cell own_cell(const Vec& p) const {
    Cell cell = cell_of(p);
    for (std::size_t a = 0; a < 3; ++a)
      if (!wrap(cell[a], a)) cell[a] = std::clamp<std::int64_t>(cell[a], 0, count_[a] - 1);
    return cell;
  }
  [[nodiscard]] std::int64_t key(const Cell& cell) const {
    return cell[0] + count_[0] * (cell[1] + count_[1] * cell[2]);
  }
  [[nodiscard]] std::size_t bucket(std::int64_t key) const {
    if (dense_) return static_cast<std::size_t>(key);
    const auto mixed = static_cast<std::uint64_t>(key) * 0x9E3779B97F4A7C15ull;
    return (mixed >> 20) & (n_buckets_ - 1);
  }

  // How far its nearest image lies from a member.
  [[nodiscard]] Vec image(std::size_t k, const Vec& from, const Images& images) const {
    if (!images.any()) return {};
    const Vec apart = place(k) - from;
    return images.nearest(apart) - apart;
  }
  // Its image between the lowest member and a period above.
  [[nodiscard]] double inside(double x, std::size_t a) const {
    return period_[a] ? x - length_[a] * std::floor((x - origin_[a]) / length_[a]) : x;
  }
  void sort(const Particles& p) {
    const std::size_t n = members.size();
    unsorted_ = members;
    unsorted_keys_.resize(n), keys_.resize(n);
    for (auto* values : {&x_, &y_, &z_, &r_}) values->resize(n);
    begin_.assign(n_buckets_ + 1, 0);
    for (std::size_t k = 0; k < n; ++k) {
      unsorted_keys_[k] = key(own_cell(get(p.place, static_cast<std::size_t>(unsorted_[k]))));
      ++begin_[bucket(unsorted_keys_[k]) + 1];
    }
    for (std::size_t b = 0; b < n_buckets_; ++b) begin_[b + 1] += begin_[b];
    next_.assign(begin_.begin(), begin_.end() - 1);
    for (std::size_t k = 0; k < n; ++k) {
      const auto at = next_[bucket(unsorted_keys_[k])]++;
      const auto i = static_cast<std::size_t>(unsorted_[k]);
      members[at] = unsorted_[k];
      keys_[at] = unsorted_keys_[k];
      x_[at] = inside(p.place[0][i], 0), y_[at] = inside(p.place[1][i], 1), z_[at] = inside(p.place[2][i], 2);
      r_[at] = 0.5 * p.contact_diameter()[i];
    }
  }

  std::vector<std::int32_t> unsorted_;
  std::vector<std::int64_t> keys_, unsorted_keys_;  // of the cells
  std::vector<std::uint32_t> begin_, next_;         // of each bucket
  std::vector<double> x_, y_, z_, r_;               // of the members
  std::array<double, 3> origin_{}, per_length_{}, length_{};
  Cell count_{};
  std::array<bool, 3> period_{};
  std::size_t n_buckets_ = 1;
  bool dense_ = true;
  double radius_ = 0;
};

inline void Company::add(const Level& level, std::size_t first, std::size_t last, const Vec& move) {
  const std::size_t begin = size, n = last - first;
  size += n;
  if (number.size() < size) {
    for (auto* values : {&x, &y, &z, &r, &gap}) values->resize(2 * size);
    number.resize(2 * size), found.resize(2 * size);
  }
  for (std::size_t k = 0; k < n; ++k) {
    x[begin + k] = level.x_[first + k] + move.x;
    y[begin + k] = level.y_[first + k] + move.y;
    z[begin + k] = level.z_[first + k] + move.z;
    r[begin + k] = level.r_[first + k];
    number[begin + k] = level.members[first + k];
  }
}

}  // namespace elrom::scene
