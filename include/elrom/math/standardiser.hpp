#pragma once
// x_sc = (x - mu_train) / sigma_train (the source's eq. 6.1), per column, from training rows only.

#include <Eigen/Core>
#include <span>

#include "elrom/math/matrix.hpp"

namespace elrom::math {

/// A column that does not vary (to 1e-12 of its size) gets
/// scale 1: it becomes zero instead of noise or infinity.
class Standardiser {
 public:
  Standardiser() = default;
  explicit Standardiser(const MatrixD& training_rows);
  Standardiser(Eigen::VectorXd mean, Eigen::VectorXd scale);

  [[nodiscard]] Eigen::Index size() const { return mean_.size(); }
  [[nodiscard]] const Eigen::VectorXd& mean() const { return mean_; }
  [[nodiscard]] const Eigen::VectorXd& scale() const { return scale_; }

  [[nodiscard]] MatrixD apply(const MatrixD& rows) const;
  [[nodiscard]] MatrixD undo(const MatrixD& rows) const;
  /// One row, without allocation; both (size()).
  void apply(std::span<const double> row, std::span<double> out) const;

 private:
  Eigen::VectorXd mean_, scale_;
};

}  // namespace elrom::math
