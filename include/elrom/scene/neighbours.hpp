#pragma once
// Which spheres are near which: pairs whose surfaces are nearer than a skin, found by cells. The list holds
// for as long as no two spheres have come nearer to each other than it by more than the skin.
//
// Spheres are sorted into levels by size (a factor of two each) with cells of their own size, so that a few
// large spheres among many small ones cost no more than their share. Each looks at its own cell and at half
// of those around. A list that is made again allocates nothing, where it is no longer than before.
//
// Thread rule: build() uses threads of its own; the list is the same for any number of them.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "elrom/scene/domain.hpp"
#include "elrom/scene/particles.hpp"

namespace elrom::scene {

class NeighbourList {
 public:
  NeighbourList();
  ~NeighbourList();
  /// Finds all pairs nearer than r_i + r_j + skin, and the spheres whose wall is nearer than r + skin.
  void build(const Particles& particles, const Domain& domain, double skin, int n_threads);

  /// Partners of a sphere with a larger number, ascending.
  [[nodiscard]] std::span<const std::int32_t> above(std::size_t i) const { return part(above_, i); }
  /// Partners with a smaller number, in an order that is the same for any number of threads.
  [[nodiscard]] std::span<const std::int32_t> below(std::size_t i) const { return part(below_, i); }
  /// Where the pairs of a sphere begin: pair k of all is (i, above(i)[k - first(i)]).
  [[nodiscard]] std::size_t first(std::size_t i) const { return above_.begin[i]; }
  [[nodiscard]] std::size_t size() const { return above_.partner.size(); }                 ///< pairs
  [[nodiscard]] const std::vector<std::int32_t>& near_wall() const { return near_wall_; }  ///< ascending
  [[nodiscard]] std::size_t bytes() const;

 private:
  struct Rows {
    std::vector<std::size_t> begin;  // (n + 1)
    std::vector<std::int32_t> partner;
  };
  [[nodiscard]] static std::span<const std::int32_t> part(const Rows& rows, std::size_t i) {
    return {rows.partner.data() + rows.begin[i], rows.begin[i + 1] - rows.begin[i]};
  }
  struct Search;
  void sort_pairs(std::size_t n);
  void find_walls(const Particles& particles, const Domain& domain, double skin, int n_threads);

  Rows above_, below_;
  std::vector<std::int32_t> near_wall_;
  std::unique_ptr<Search> search_;
};

/// The skin with which a list costs least over its life, m: a wide one lasts longer and holds more pairs.
/// From the mean diameter and the spheres that one has around it, so that dilute scenes get wide skins.
/// @param travel of the fastest sphere in a step, m. @param look seconds a step that a pair of the list costs
[[nodiscard]] double best_skin(const Particles& particles, double travel, double look);

/// Pairs that overlap by more than `share` of the smaller diameter, and the first of them.
struct Overlaps {
  std::size_t n = 0;
  std::int32_t i = 0, j = 0;
};
[[nodiscard]] Overlaps overlaps_of(const Particles& particles, const Domain& domain, double share,
                                   int n_threads);

}  // namespace elrom::scene
