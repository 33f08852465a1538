#pragma once
// Decompositions of symmetric matrices, compiled once: a source that has Eigen's own templates compile them
// takes seconds longer for each. Any unit. A call works in the caller's thread and shares nothing. Golub &
// Van Loan, Matrix Computations, 4th ed.: Cholesky section 4.2.5, symmetric QR algorithm section 8.3.

#include <Eigen/Core>

namespace elrom::math {

/// A = V diag(values) V^T
struct SymmetricEigen {
  Eigen::VectorXd values;   //!< (n), ascending
  Eigen::MatrixXd vectors;  //!< (n, n), one a column, orthonormal
  bool converged = false;   //!< false where A is not finite
};

/// @param matrix A (n, n); its lower triangle is read
[[nodiscard]] SymmetricEigen symmetric_eigen(const Eigen::MatrixXd& matrix);

/// Products of rows less their mean, from the products of the rows: C G C with C = I - 1 1^T / n.
/// @param gram G (n, n)
[[nodiscard]] Eigen::MatrixXd centred_products(Eigen::MatrixXd gram);

/// Of all X that make |A X - B| least the smallest, by the pseudo-inverse (section 5.5.2): A may be singular
/// and indefinite.
/// @param matrix A (n, n); its lower triangle is read @param right B (n, m)
[[nodiscard]] Eigen::MatrixXd least_norm_solution(const Eigen::MatrixXd& matrix,
                                                  const Eigen::MatrixXd& right);

/// K = L L^T
class Cholesky {
 public:
  /// @param matrix K (n, n); its lower triangle is read
  explicit Cholesky(const Eigen::MatrixXd& matrix);

  /// K is positive definite; the rest means nothing otherwise.
  [[nodiscard]] bool succeeded() const { return succeeded_; }
  /// K^-1 (n, n)
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  /// L^-1 (n, n), lower triangular
  [[nodiscard]] Eigen::MatrixXd inverse_factor() const;
  /// K^-1 right. @param right (n, m)
  [[nodiscard]] Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;
  /// ln det K
  [[nodiscard]] double log_determinant() const;

 private:
  Eigen::MatrixXd lower_;  //!< L in the lower triangle; the other is not read
  bool succeeded_;
};

}  // namespace elrom::math
