#include "elrom/scene/cell_grid.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"

namespace elrom::scene {
namespace {

constexpr double most_cells = 5e6;
constexpr int samples = 4;  // a cell's inside is sought at so many points each way

// Along one axis: the two nodes around a place and how near the upper one is.
struct Along {
  std::int64_t below;
  double share;
};
Along along(double x, double low, double step, double first) {
  const double at = std::clamp((x - low) / step - first, -1e9, 1e9), below = std::floor(at);
  return {static_cast<std::int64_t>(below), at - below};
}

}  // namespace

CellGrid::CellGrid(const Domain& domain, const Vec& size) {
  if (domain.unbounded())
    throw UsageError(Problem{.what = "a grid over all of space", .expected = "[[domain.boxes]]"});
  const auto low = array_of(domain.low()), high = array_of(domain.high()), wished = array_of(size),
             period = array_of(domain.images().period);
  double cells = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    const double n = std::max(1.0, std::ceil((high[a] - low[a]) / wished[a] * (1 - 1e-9)));
    cells *= n;
    if (!(cells <= most_cells))
      throw UsageError(Problem{.what = "too many cells in the grid",
                               .expected = fmt::format("at most {:.0f}", most_cells),
                               .advice = "a larger grid.cell"});
    low_[a] = low[a], step_[a] = (high[a] - low[a]) / n, count_[a] = static_cast<std::size_t>(n);
    periodic_[a] = period[a] > 0;
  }
  const auto n = static_cast<std::size_t>(cells);
  open_.assign(n, 0), space_.assign(n, 0);
  for (std::size_t c = 0; c < n; ++c) {
    space_[c] = space_of(domain, c);
    open_[c] = space_[c] >= 0.5 * volume() ? 1 : 0;
  }
  find_hosts();
  for (std::size_t a = 0; a < 3; ++a) {
    faces_[a].assign(n + n / count_[a], beyond);
    for (std::size_t c = 0; c < n; ++c)
      for (const int side : {-1, 1}) {
        const auto other = neighbour(c, a, side);
        const bool both = other != none && is_open(static_cast<std::size_t>(other));
        if (is_open(c)) faces_[a][face(c, a, side)] = both ? inside : wall;
      }
  }
}

CellGrid::Index CellGrid::index(std::size_t cell) const {
  return {cell % count_[0], cell / count_[0] % count_[1], cell / count_[0] / count_[1]};
}

Vec CellGrid::centre(std::size_t cell) const {
  const auto at = index(cell);
  const auto x = [&](std::size_t a) { return low_[a] + step_[a] * (static_cast<double>(at[a]) + 0.5); };
  return {x(0), x(1), x(2)};
}

double CellGrid::space_of(const Domain& domain, std::size_t cell) const {
  const Vec middle = centre(cell);
  const double half = 0.5 * std::sqrt(step_[0] * step_[0] + step_[1] * step_[1] + step_[2] * step_[2]);
  if (domain.room(middle) > half) return volume();
  int inside = 0;
  for (int k = 0; k < samples * samples * samples; ++k) {
    const auto off = [&](int j, std::size_t a) { return ((j % samples + 0.5) / samples - 0.5) * step_[a]; };
    const Vec point{off(k, 0), off(k / samples, 1), off(k / samples / samples, 2)};
    inside += domain.contains(middle + point) ? 1 : 0;
  }
  return volume() * inside / (samples * samples * samples);
}

// Outwards from the open cells, a layer at a time.
void CellGrid::find_hosts() {
  host_.assign(size(), none);
  std::vector<std::int32_t> layer, next;
  for (std::size_t c = 0; c < size(); ++c)
    if (is_open(c)) host_[c] = static_cast<std::int32_t>(c), layer.push_back(host_[c]);
  if (layer.empty())
    throw UsageError(
        Problem{.what = "no cell of the grid lies inside the domain", .advice = "a smaller grid.cell"});
  for (; !layer.empty(); layer.swap(next), next.clear())
    for (const auto c : layer)
      for (std::size_t a = 0; a < 3; ++a)
        for (const int side : {-1, 1}) {
          const auto other = neighbour(static_cast<std::size_t>(c), a, side);
          if (other == none || host_[static_cast<std::size_t>(other)] != none) continue;
          host_[static_cast<std::size_t>(other)] = host_[static_cast<std::size_t>(c)];
          next.push_back(other);
        }
}

std::int32_t CellGrid::neighbour(std::size_t cell, std::size_t axis, int side) const {
  const auto at = index(cell);
  const std::size_t stride = axis == 0 ? 1 : axis == 1 ? count_[0] : count_[0] * count_[1];
  const bool ends = side < 0 ? at[axis] == 0 : at[axis] + 1 == count_[axis];
  if (ends && !periodic_[axis]) return none;
  const std::size_t round = stride * (count_[axis] - 1);
  if (side < 0) return static_cast<std::int32_t>(ends ? cell + round : cell - stride);
  return static_cast<std::int32_t>(ends ? cell - round : cell + stride);
}

std::size_t CellGrid::face(std::size_t cell, std::size_t axis, int side) const {
  if (side < 0) return cell;
  const auto after = neighbour(cell, axis, 1);
  if (after != none) return static_cast<std::size_t>(after);
  const auto at = index(cell);
  const std::size_t b = axis == 0 ? 1 : 0, c = axis == 2 ? 1 : 2;
  return size() + at[b] + count_[b] * at[c];
}

std::size_t CellGrid::cell_at(const Vec& place) const {
  const auto x = array_of(place);
  Index at;
  for (std::size_t a = 0; a < 3; ++a) {
    double along = std::floor((x[a] - low_[a]) / step_[a]);
    const auto n = static_cast<double>(count_[a]);
    if (periodic_[a]) along -= n * std::floor(along / n);
    at[a] = static_cast<std::size_t>(std::clamp(along, 0.0, n - 1));
  }
  return static_cast<std::size_t>(host_[cell(at)]);
}

namespace {

// The eight nodes around a place. @param node(at) number of one that is open, or none
template <class Node>
Shares shares_of(const std::array<Along, 3>& a, const Node& node, std::int32_t otherwise) {
  Shares shares{};
  double sum = 0;
  for (std::size_t k = 0; k < 8; ++k) {
    std::array<std::int64_t, 3> at;
    double weight = 1;
    for (std::size_t x = 0; x < 3; ++x) {
      const bool upper = (k >> x & 1) != 0;
      at[x] = a[x].below + (upper ? 1 : 0);
      weight *= upper ? a[x].share : 1 - a[x].share;
    }
    const auto number = weight > 0 ? node(at) : CellGrid::none;
    shares.of[k] = number == CellGrid::none ? otherwise : number;
    shares.weight[k] = number == CellGrid::none ? 0 : weight;
    sum += shares.weight[k];
  }
  if (sum > 1e-9) {
    for (auto& weight : shares.weight) weight /= sum;
  } else {
    shares.of.fill(otherwise);
    shares.weight = {1};
  }
  return shares;
}

}  // namespace

Shares CellGrid::cells(const Vec& place) const {
  const auto x = array_of(place);
  std::array<Along, 3> a;
  for (std::size_t k = 0; k < 3; ++k) a[k] = along(x[k], low_[k], step_[k], 0.5);
  const auto node = [&](const std::array<std::int64_t, 3>& at) -> std::int32_t {
    Index of;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto n = static_cast<std::int64_t>(count_[k]);
      if (!periodic_[k] && (at[k] < 0 || at[k] >= n)) return none;
      of[k] = static_cast<std::size_t>((at[k] % n + n) % n);
    }
    const auto c = cell(of);
    return is_open(c) ? static_cast<std::int32_t>(c) : none;
  };
  return shares_of(a, node, static_cast<std::int32_t>(cell_at(place)));
}

Shares CellGrid::faces(const Vec& place, std::size_t axis, std::uint8_t least) const {
  const auto x = array_of(place);
  std::array<Along, 3> a;
  for (std::size_t k = 0; k < 3; ++k) a[k] = along(x[k], low_[k], step_[k], k == axis ? 0 : 0.5);
  const auto node = [&](const std::array<std::int64_t, 3>& at) -> std::int32_t {
    Index of;
    bool is_last = false;  // in the layer behind the grid's high end
    for (std::size_t k = 0; k < 3; ++k) {
      const auto n = static_cast<std::int64_t>(count_[k]);
      const bool high_end = k == axis && at[k] == n;
      if (!periodic_[k] && (at[k] < 0 || (at[k] >= n && !high_end))) return none;
      is_last = is_last || (high_end && !periodic_[k]);
      of[k] = static_cast<std::size_t>(high_end && !periodic_[k] ? n - 1 : (at[k] % n + n) % n);
    }
    const auto f = face(cell(of), axis, is_last ? 1 : -1);
    return faces_[axis][f] >= least ? static_cast<std::int32_t>(f) : none;
  };
  return shares_of(a, node, static_cast<std::int32_t>(face(cell_at(place), axis, -1)));
}

std::size_t CellGrid::bytes() const {
  std::size_t total =
      open_.capacity() + space_.capacity() * sizeof(double) + host_.capacity() * sizeof(std::int32_t);
  for (const auto& faces : faces_) total += faces.capacity();
  return total;
}

}  // namespace elrom::scene
