#pragma once
// From the cells of the reduced mesh to other cells, as a sparse operator made once: a row of source cells
// and weights for each target.
//
//   conservative  every source cell is split into k^3 parts (by its trilinear map; k grows with the number
//                 of targets), and each part belongs to the target that it lies in: weights are volumes,
//                 values are means over what of the reduced mesh lies in a target. Exact where one mesh
//                 refines the other. Of targets without faces the one with the nearest centre takes a part,
//                 and those whose centres lie outside the reduced mesh take none.
//   trilinear     values at the corners of the source's hexahedra (means of the cells around, by volume),
//                 taken trilinearly at the target's centre.
//
// Both are means: no value leaves the range of its source, and constants stay. A target that has no part of
// the reduced mesh, or whose centre lies in none of its cells, takes the nearest cell and is counted.
//
// Thread rule: const use from any thread. The operator does not depend on the number of threads.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "elrom/field/mesh.hpp"
#include "elrom/fields/onto_options.hpp"

namespace elrom::fields {

/// Where values are wanted.
struct Places {
  MatrixD centre;              //!< [m], (n, 3)
  std::vector<double> volume;  //!< [m3], (n); empty: not known
  /// Whether a point [m] lies in a cell; empty: it lies in the one whose centre is nearest.
  std::function<bool(std::size_t cell, const Eigen::Vector3d& point)> contains;
};

class Interpolator {
 public:
  /// @param from with its corners
  Interpolator(const field::Mesh& from, const Places& to, Interpolation how, int n_threads);

  [[nodiscard]] std::size_t n_target() const { return begin_.size() - 1; }
  /// Targets that took the nearest cell.
  [[nodiscard]] std::size_t n_outside() const { return n_outside_; }
  /// @param values (n_source) @param importance of each source cell beside its weight, such as its share of
  /// solids: a velocity's mean then keeps momentum. Empty: all alike. @param result (n_target)
  void apply(std::span<const float> values, std::span<const float> importance, std::span<float> result) const;
  /// Conservative: sum of value x volume over the parts that lie in targets. Trilinear: nothing.
  [[nodiscard]] double integral(std::span<const float> values) const;

 private:
  struct Entry {
    std::int32_t cell;
    float weight;
  };
  void conservative(const field::Mesh& from, const Places& to, int n_threads);
  void trilinear(const field::Mesh& from, const Places& to, int n_threads);
  void take_nearest(const field::Mesh& from, const Places& to, std::vector<std::vector<Entry>>& rows);

  std::vector<std::size_t> begin_;  //!< entries of each target, (n_target + 1)
  std::vector<Entry> entries_;
  std::vector<bool> nearest_;  //!< targets that took the nearest cell
  std::size_t n_outside_ = 0;
};

}  // namespace elrom::fields
