#pragma once
// Kernel smoother of mode coefficients on derived inputs, with groups of modes that have a covariance of
// their own. Used by the method "kernel": in each zone of height, one group for each leading mode of the
// symmetric part of a field and one for the others, and one for each antisymmetric part.

#include <memory>
#include <string>
#include <vector>

#include "elrom/math/kernel.hpp"
#include "elrom/math/standardiser.hpp"
#include "elrom/model/coefficient_model.hpp"
#include "elrom/model/feature_map.hpp"

namespace elrom::model {

/// Covariance of two cases with standardised derived inputs z and z', m(r) = Matern 5/2 or Gaussian:
///   symmetric      k = m(r) + linear * (a . a') + constant
///   antisymmetric  k = (u . u' + constant) * (linear + m(r)), odd in u where constant is 0: then a mirrored
///                  case gives the mirrored answer. What the constant stands for keeps its side
/// with a = z * inverse_lengths, r = |a - a'|, u = z * imbalance.
struct SmootherKernel {
  bool antisymmetric = false;
  math::Covariance covariance = math::Covariance::matern52;  ///< m(r)
  double linear = 0;
  double constant = 0;
  double noise = 1;                 ///< added to the covariance of a case with itself
  Eigen::VectorXd inverse_lengths;  //!< (n_features); 0: not used
  Eigen::VectorXd imbalance;        //!< (n_features); 0: not used

  [[nodiscard]] double operator()(const double* z, const double* z_other) const;
  /// Between the rows of two tables, (n, m).
  [[nodiscard]] Eigen::MatrixXd matrix(const MatrixD& z, const MatrixD& z_other) const;
};

/// Thread rule: const use from any number of threads, each with a Workspace of its own.
class SmootherCoefficients final : public CoefficientModel {
 public:
  struct Group {
    SmootherKernel kernel;
    MatrixD weights;         //!< coefficient = k(x) . weights, (n_cases, n_modes of the group)
    Eigen::VectorXd signal;  //!< variance of each coefficient at k = 1, (n_modes of the group)
    MatrixF inverse_factor;  //!< L^-1 of (K + noise I) = L L^T, lower triangular, (n_cases, n_cases)
    std::size_t zone = 0;    ///< of height, that the modes belong to, counted from the bottom
  };
  /// @param z standardised derived inputs of the training cases, (n_cases, n_features)
  SmootherCoefficients(FeatureMap features, math::Standardiser scaler, MatrixD z, std::vector<Group> groups);

  [[nodiscard]] std::string kind() const override { return "smoother"; }
  [[nodiscard]] std::size_t n_inputs() const override { return features_.n_inputs(); }
  [[nodiscard]] std::size_t n_coefficients() const override { return n_coefficients_; }
  [[nodiscard]] std::size_t n_cases() const { return static_cast<std::size_t>(z_.rows()); }
  [[nodiscard]] const FeatureMap& features() const { return features_; }
  [[nodiscard]] const std::vector<Group>& groups() const { return groups_; }
  /// The smoother of other cases, with its hyperparameters kept and the rest exact: the weights of the cases
  /// about their own mean (an antisymmetric group has none). The smoother holds its cases' coefficients, y =
  /// (K + noise I) weights.
  struct Changed {
    std::shared_ptr<const SmootherCoefficients> coefficients;
    Eigen::VectorXd mean_shift;  //!< by which the mean of the cases moves, in modes, (n_coefficients)
  };
  /// @param i_case one of at least two. @throws NumericalError when the others' covariance has no factor
  [[nodiscard]] Changed without_case(std::size_t i_case) const;
  /// @param coefficients of the case about the present mean, (n_coefficients). @throws as above
  [[nodiscard]] Changed with_case(std::span<const double> inputs, const Eigen::VectorXd& coefficients) const;
  void predict(std::span<const double> inputs, std::span<double> coefficients, std::span<double> variance,
               bool best_build_only, Workspace& workspace) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<CoefficientModel> load(const io::TensorFile& file,
                                                              const std::string& prefix);

 private:
  [[nodiscard]] MatrixD coefficients_of_cases() const;  // (n_cases, n_coefficients)
  [[nodiscard]] Changed of_other_cases(MatrixD z, const MatrixD& cases) const;

  FeatureMap features_;
  math::Standardiser scaler_;
  MatrixD z_;
  std::vector<Group> groups_;
  std::size_t n_coefficients_ = 0;
};

}  // namespace elrom::model
