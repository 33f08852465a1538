#pragma once
// From the cells of a CFD mesh to those of the reduced mesh: a sparse linear operator, computed once per pair
// of meshes.
//
// Method. Every source cell belongs to the target whose centre is nearest; the parents of a target are the
// cells that belong to it, or, where none does, the nearest source cell. Value at a target's centre x:
//
//     f(x) = mean of parents + (mean gradient of parents) . (x - mean centre of parents)
//
// with means weighted by volume, and each parent's gradient by least squares over its nearest neighbours,
// weighted by the inverse square of the distance. Fields linear in x are reproduced exactly, a coarse target
// takes the mean of its parents, and where children surround their parent evenly they average back to it.
//
// Limits. The value is kept between the smallest and largest value of
//   - the cells it is made of, where x lies in the hull of their centres (a linear field is
//     never touched there);
//   - all cells, where x lies only in the hull of all centres;
//   - the cells it is made of, where x lies outside (the outer half cells at walls): extrapolation gives
//     no new extremes.
// So positive fields stay positive, and no value leaves the range of its source.
//
// Non-goals: conservation over partly overlapping cells, moving meshes.

#include <cstdint>
#include <span>
#include <stop_token>
#include <vector>

#include "elrom/math/matrix.hpp"

namespace elrom::ingest {

/// Thread rule: const use from any thread. The operator does not depend on the number of threads.
class Resampler {
 public:
  /// @param source_centre [m], (n_source, 3), finite  @param source_volume [m3], (n_source); empty: all alike
  /// @param target_centre [m], (n_target, 3)
  /// @throws InputError for a source without cells
  Resampler(const MatrixD& source_centre, std::span<const double> source_volume, const MatrixD& target_centre,
            int n_threads = 1, const std::stop_token& stop = {});

  [[nodiscard]] std::size_t n_source() const { return n_source_; }
  [[nodiscard]] std::size_t n_target() const { return limits_.size(); }
  /// Targets outside the hull of all source centres.
  [[nodiscard]] std::size_t n_outside() const;
  /// Those of them that the source does not reach: farther from the nearest source cell than that is from the
  /// neighbours that its gradient is made of.
  [[nodiscard]] std::size_t n_far() const;
  /// @param source (n_source)  @param target (n_target)
  void apply(std::span<const float> source, std::span<float> target) const;
  /// Every row: (n_fields, n_source) -> (n_fields, n_target).
  [[nodiscard]] MatrixF apply(const MatrixF& source) const;

 private:
  enum class Limit : std::uint8_t { stencil, everything, stencil_outside };
  std::size_t n_source_ = 0;
  std::vector<std::size_t> begin_;  //!< entries of each target, (n_target + 1)
  std::vector<std::int32_t> cell_;  //!< source cell, (n_entries)
  std::vector<double> weight_;      //!< (n_entries)
  std::vector<Limit> limits_;       //!< (n_target)
  std::vector<char> is_far_;        //!< (n_target)
};

/// Error of going to the reduced mesh and back, per field: root mean square over cells, relative to the
/// field's own standard deviation (to its largest magnitude where it is constant), (n_fields).
[[nodiscard]] std::vector<double> round_trip_error(const MatrixF& original, const MatrixF& back);

}  // namespace elrom::ingest
