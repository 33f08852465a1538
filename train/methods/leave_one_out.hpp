#pragma once
// Hyperparameters of a smoother by the leave-one-case-out error of whole fields, in closed form, and of a
// mode by its likelihood; internal to methods.

#include <Eigen/Core>
#include <span>

#include "elrom/math/kernel.hpp"
#include "elrom/math/matrix.hpp"
#include "elrom/model/smoother_coefficients.hpp"

namespace elrom::methods {

/// Sum over cases and cells of squared leave-one-out residuals of the smoother H = K (K + noise I)^-1, which
/// are (P y)_i / P_ii with P = (K + noise I)^-1; only the cases' Gram matrix G = Y Y^T is needed: J = sum_i
/// (P G P)_ii / P_ii^2.
/// @param slope if given, dJ / dK, symmetric, (n_cases, n_cases)
[[nodiscard]] double leave_one_out_error(const Eigen::MatrixXd& covariance, double noise,
                                         const Eigen::MatrixXd& gram, Eigen::MatrixXd* slope = nullptr);

/// Mean of the cases' gains, in standard errors of that mean; 0: none. @param gains (n_cases)
[[nodiscard]] double significance(const Eigen::VectorXd& gains);

/// One length scale for each input, and the noise beside a signal of 1.
struct StationaryKernel {
  Eigen::VectorXd lengths;  //!< (n_inputs)
  double noise = 1;
  double error = 0;  ///< leave_one_out_error()
};

/// Lengths and noise of the least leave-one-out error among searches from each of `starts`.
/// @param x standardised inputs, (n_cases, n_inputs) @param isotropic one length for all inputs
/// @param starts lengths and noise; lengths of one entry, or one an input
[[nodiscard]] StationaryKernel fit_stationary_kernel(const MatrixD& x, const Eigen::MatrixXd& gram,
                                                     math::Covariance covariance, bool isotropic,
                                                     std::span<const StationaryKernel> starts);

/// @param z standardised features, (n_cases, n_features) @param used features of the symmetric part
/// @param near a kernel of the same features to search from, in a few steps; nullptr: from the usual start
[[nodiscard]] model::SmootherKernel fit_symmetric_kernel(const MatrixD& z,
                                                         const std::vector<Eigen::Index>& used,
                                                         const Eigen::MatrixXd& gram,
                                                         math::Covariance covariance,
                                                         const model::SmootherKernel* near = nullptr);

/// The kernel of one mode of a field: of all departures from the field's own, in the logarithms of lengths
/// and noise, the one that the mode's coefficients make most probable (Rasmussen & Williams 2006, eq. 2.30,
/// with the signal of the largest likelihood) where departures are normal a priori. So a mode that its few
/// cases say little about keeps near to what the whole field says.
/// @param coefficients of the cases, (n_cases) @param field symmetric
[[nodiscard]] model::SmootherKernel fit_mode_kernel(const MatrixD& z, const Eigen::VectorXd& coefficients,
                                                    const model::SmootherKernel& field);

/// What an antisymmetric part is learned from.
struct Asymmetry {
  std::vector<Eigen::Index> imbalances;  //!< features
  bool lasting = false;                  ///< and the asymmetry that all cases share, the kernel's constant
};

/// @param symmetric the field's symmetric kernel: its lengths are kept, up to one common factor
/// @param from imbalances, or a lasting asymmetry, or both @param near as above
[[nodiscard]] model::SmootherKernel fit_antisymmetric_kernel(const MatrixD& z,
                                                             const model::SmootherKernel& symmetric,
                                                             const Asymmetry& from,
                                                             const Eigen::MatrixXd& gram,
                                                             const model::SmootherKernel* near = nullptr);

}  // namespace elrom::methods
