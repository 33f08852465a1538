#pragma once
// Zones of height. A furnace is one thing at its bottom and another at its top: what inputs do to a field
// changes with height, and one smoother for all heights is right nowhere. Each zone has its own, and zones
// fade into each other, so no seam is seen. Internal to methods.

#include <Eigen/Core>
#include <vector>

#include "elrom/math/matrix.hpp"
#include "fundamental_domain.hpp"

namespace elrom::methods {

/// Some neighbouring planes, and how much each of their cells counts.
struct Zone {
  std::size_t first_plane = 0, n_planes = 0;
  Eigen::Index first_cell = 0;
  Eigen::RowVectorXf weights;  //!< of its cells, above 0

  /// Its cells of `rows`. @param rows (n, n_cells)
  [[nodiscard]] auto part(const MatrixF& rows) const { return rows.middleCols(first_cell, weights.size()); }
  /// A W B^T over its cells, in double, (n, m). Of a matrix with itself, the same object, one triangle is
  /// computed. @param a (n, n_cells) @param b (m, n_cells)
  [[nodiscard]] Eigen::MatrixXd gram(const MatrixF& a, const MatrixF& b) const;
  /// sum += what is predicted for its cells, weighted. @param predicted (n, weights.size())
  void add(MatrixF& sum, const MatrixF& predicted) const;
};

/// Zones with their middles at equal distances from the first plane to the last, so those at the ends are
/// half as high; on every plane the weights add up to 1. Where zones would have less than two planes each, or
/// a mirror takes cells to other planes or moves columns otherwise on each, one zone that is everything.
[[nodiscard]] std::vector<Zone> zones_of(const FundamentalDomain& domain, std::size_t n_zones);

}  // namespace elrom::methods
