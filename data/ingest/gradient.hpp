#pragma once
// Least-squares gradients on a cloud of cell centres, as coefficients on the cells' values.

#include <memory>
#include <utility>
#include <vector>

#include "elrom/math/matrix.hpp"
#include "point_hull.hpp"

namespace elrom::ingest {

/// gradient = sum over entries of coefficient * value(cell); the cell itself is among them.
struct Gradient {
  std::vector<std::pair<std::int32_t, Point>> entries;
};

/// Thread rule: const use from any thread.
class CellCloud {
 public:
  /// @param centre [m], (n, 3); kept by reference
  explicit CellCloud(const MatrixD& centre);
  ~CellCloud();
  CellCloud(const CellCloud&) = delete;
  CellCloud& operator=(const CellCloud&) = delete;

  [[nodiscard]] std::size_t size() const { return static_cast<std::size_t>(centre_.rows()); }
  [[nodiscard]] Point at(std::size_t cell) const;
  /// The k nearest cells and all that are as far as the last of them, so that a symmetric mesh gives
  /// symmetric stencils.
  [[nodiscard]] std::vector<std::int32_t> nearest(const Point& x, std::size_t k) const;
  /// Weights 1 / distance^2. The stencil grows until the directions span space well; directions that no cell
  /// spans (a flat or straight mesh) get no gradient.
  [[nodiscard]] Gradient gradient(std::size_t cell) const;

 private:
  struct Tree;
  const MatrixD& centre_;
  std::unique_ptr<Tree> tree_;
};

}  // namespace elrom::ingest
