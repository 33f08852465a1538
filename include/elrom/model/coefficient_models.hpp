#pragma once
// The closed-form predictors of mode coefficients: linear, Gaussian processes, radial basis functions.

#include <memory>
#include <vector>

#include "elrom/math/gaussian_process.hpp"
#include "elrom/math/rbf.hpp"
#include "elrom/math/ridge.hpp"
#include "elrom/math/standardiser.hpp"
#include "elrom/model/coefficient_model.hpp"

namespace elrom::model {

/// coefficients = x W + b on standardised inputs.
class LinearCoefficients final : public CoefficientModel {
 public:
  /// @param variance of the coefficients' errors, (n_coefficients)
  LinearCoefficients(math::Standardiser scaler, MatrixD weights, Eigen::VectorXd intercept,
                     Eigen::VectorXd variance);
  [[nodiscard]] std::string kind() const override { return "linear"; }
  [[nodiscard]] std::size_t n_inputs() const override { return static_cast<std::size_t>(weights_.rows()); }
  [[nodiscard]] std::size_t n_coefficients() const override {
    return static_cast<std::size_t>(weights_.cols());
  }
  void predict(std::span<const double> inputs, std::span<double> coefficients, std::span<double> variance,
               bool best_build_only, Workspace& workspace) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<CoefficientModel> load(const io::TensorFile& file,
                                                              const std::string& prefix);

 private:
  math::Standardiser scaler_;
  MatrixD weights_;
  Eigen::VectorXd intercept_, variance_;
};

/// One Gaussian process for all coefficients, or one for each; targets are scaled to unit variance.
class GpCoefficients final : public CoefficientModel {
 public:
  /// @param inputs standardised training inputs, (n_cases, n_inputs)
  /// @param processes one (shared by all targets) or one for
  /// every target, fitted on inputs and targets / scale
  /// @param scale standard deviation of each coefficient, (n_coefficients)
  GpCoefficients(math::Standardiser scaler, const MatrixD& inputs,
                 const std::vector<math::GaussianProcess>& processes, const Eigen::VectorXd& scale);
  [[nodiscard]] std::string kind() const override { return "gp"; }
  [[nodiscard]] std::size_t n_inputs() const override { return static_cast<std::size_t>(scaler_.size()); }
  [[nodiscard]] std::size_t n_coefficients() const override {
    return static_cast<std::size_t>(scale_.size());
  }
  void predict(std::span<const double> inputs, std::span<double> coefficients, std::span<double> variance,
               bool best_build_only, Workspace& workspace) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<CoefficientModel> load(const io::TensorFile& file,
                                                              const std::string& prefix);

 private:
  GpCoefficients() = default;
  void kernel_row(std::size_t i_kernel, std::span<const double> scaled, std::span<double> k) const;

  math::Standardiser scaler_;
  math::Covariance covariance_ = math::Covariance::matern52;
  MatrixD inputs_;          //!< standardised, (n_cases, n_inputs)
  MatrixD lengths_;         //!< (n_kernels, n_inputs)
  Eigen::VectorXd signal_;  //!< signal variance, (n_kernels)
  MatrixD weights_;         //!< K^-1 targets, times scale, (n_cases, n_coefficients)
  Eigen::VectorXd scale_;   //!< (n_coefficients)
  //! L^-1, f32: read only where the variance is asked for, (n_kernels, n_cases, n_cases)
  io::Tensor inverse_factor_;
};

/// Radial basis functions on standardised inputs.
class RbfCoefficients final : public CoefficientModel {
 public:
  /// @param variance of the coefficients' errors, (n_coefficients)
  RbfCoefficients(math::Standardiser scaler, math::RbfInterpolator interpolator, Eigen::VectorXd variance);
  [[nodiscard]] std::string kind() const override { return "rbf"; }
  [[nodiscard]] std::size_t n_inputs() const override { return static_cast<std::size_t>(scaler_.size()); }
  [[nodiscard]] std::size_t n_coefficients() const override {
    return static_cast<std::size_t>(variance_.size());
  }
  void predict(std::span<const double> inputs, std::span<double> coefficients, std::span<double> variance,
               bool best_build_only, Workspace& workspace) const override;
  void save(io::TensorFile& file, const std::string& prefix) const override;
  [[nodiscard]] static std::unique_ptr<CoefficientModel> load(const io::TensorFile& file,
                                                              const std::string& prefix);

 private:
  math::Standardiser scaler_;
  math::RbfInterpolator interpolator_;
  Eigen::VectorXd variance_;
};

}  // namespace elrom::model
