#pragma once
// A linear equation over the open cells of a grid, of the kind that pressures obey, and what solves it: one
// seam, so that another library can. Internal.
//
//   diagonal_c q_c + sum over faces of c: conductance_f (q_c - q_other) = right_c
//
// Faces without a conductance are walls. The matrix is symmetric and not negative.

#include <memory>

#include "elrom/scene/cell_grid.hpp"

namespace elrom::scene {

struct CellEquation {
  explicit CellEquation(const CellGrid& grid) : diagonal(grid.size()), right(grid.size()) {
    for (std::size_t a = 0; a < 3; ++a) conductance[a].resize(grid.face_count(a));
  }
  void clear() {
    for (auto* values : {&diagonal, &right, &conductance[0], &conductance[1], &conductance[2]})
      values->assign(values->size(), 0);
  }
  std::vector<double> diagonal, right;             ///< by cell
  std::array<std::vector<double>, 3> conductance;  ///< by face along each axis
};

class CellSolver {
 public:
  virtual ~CellSolver() = default;
  /// @param q by cell; what it holds is where the search begins. Of closed cells: untouched. Where all
  /// diagonals are 0, the mean of the right side is taken off, and q is 0 in the first open cell, or so
  /// @param tolerance of the residual, over that of the right side @return iterations
  /// @throws NumericalError where it does not get there
  virtual int solve(const CellEquation& equation, std::vector<double>& q, double tolerance) = 0;
};

/// Eigen's conjugate gradients with an incomplete Cholesky factor. @param grid lives longer
[[nodiscard]] std::unique_ptr<CellSolver> make_eigen_solver(const CellGrid& grid);

}  // namespace elrom::scene
