#pragma once
// Proper orthogonal decomposition by the method of snapshots (Sirovich 1987): the eigenvectors of the cases'
// Gram matrix give the modes; cost grows with n_cases^2 * n_cells, never with n_cells^2.

#include <Eigen/Core>
#include <span>

#include "elrom/math/matrix.hpp"

namespace elrom::math {

/// Whichever limit is reached first; a limit at its default does not count.
struct PodTruncation {
  std::size_t n_modes = 0;  ///< at most so many; 0: all that are not rounding
  double energy = 1;        ///< fewest modes that hold this share of the variance, in (0, 1]
};

struct Pod {
  Eigen::VectorXd mean;      //!< of the rows, (n_cells)
  MatrixF modes;             //!< orthonormal, (n_modes, n_cells); the entry largest in size is positive
  MatrixD coefficients;      //!< of the rows it was made from, (n_rows, n_modes)
  Eigen::VectorXd energies;  //!< sum of squares of each mode's coefficients, (n_modes), descending
  double total_energy = 0;   //!< of all modes, kept or not

  [[nodiscard]] std::size_t n_modes() const { return static_cast<std::size_t>(modes.rows()); }
};

/// Means over the given rows, (n_cells), in double.
[[nodiscard]] Eigen::VectorXd row_mean(const MatrixF& values, std::span<const std::size_t> rows,
                                       int n_threads = 1);

/// Gram matrix of the given rows less `offset`, (n_rows, n_rows), accumulated in double over blocks of cells.
/// The bits do not depend on n_threads.
[[nodiscard]] Eigen::MatrixXd gram(const MatrixF& values, std::span<const std::size_t> rows,
                                   const Eigen::VectorXd& offset, int n_threads = 1);

/// Linear combinations of rows: weights (n_out, n_rows) times (values[rows] - offset), (n_out, n_cells).
[[nodiscard]] MatrixF combine_rows(const Eigen::MatrixXd& weights, const MatrixF& values,
                                   std::span<const std::size_t> rows, const Eigen::VectorXd& offset,
                                   int n_threads = 1);

/// @param values (n_cases, n_cells), of which `rows` count
[[nodiscard]] Pod make_pod(const MatrixF& values, std::span<const std::size_t> rows,
                           const PodTruncation& truncation = {}, int n_threads = 1);

}  // namespace elrom::math
