#include "smoother_modes.hpp"

#include <algorithm>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "leave_one_out.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// The cases' products, each one's with itself without its noise.
MatrixXd without_own_noise(MatrixXd gram, const Smoother& smoother, const model::SmootherKernel& kernel) {
  const MatrixXd others =
      kernel.antisymmetric ? smoother.leave_one_out() : smoother.leave_one_out_about_mean();
  const VectorXd predicted = others.cwiseProduct(gram).rowwise().sum(), itself = gram.diagonal();
  const VectorXd unpredicted = itself - predicted.cwiseMax(0).cwiseMin(itself);
  gram.diagonal() -= kernel.noise * smoother.precision.diagonal().cwiseProduct(unpredicted);
  return gram;
}

/// The first modes, until the rest holds no more energy than it may.
Index enough_modes(const VectorXd& energies, const ModeLimits& limits) {
  const double total = energies.cwiseMax(0).sum();
  double left = total;
  Index n = 0;
  while (n < energies.size() && n < static_cast<Index>(limits.most) && energies[n] > 1e-13 * total &&
         left > limits.may_drop)
    left -= energies[n++];
  return n;
}

}  // namespace

Smoother::Smoother(const model::SmootherKernel& kernel, const MatrixD& z) : covariance(kernel.matrix(z, z)) {
  MatrixXd k = covariance;
  k.diagonal().array() += kernel.noise;
  const math::Cholesky factor(k);
  if (!factor.succeeded()) throw NumericalError("kernel smoother: the covariance is not positive definite");
  precision = factor.inverse();
  inverse_factor = factor.inverse_factor();
}

MatrixXd Smoother::leave_one_out() const {
  MatrixXd operation = -(precision.diagonal().cwiseInverse().asDiagonal() * precision);
  operation.diagonal().array() += 1;
  return operation;
}

MatrixXd Smoother::leave_one_out_about_mean() const {
  MatrixXd operation = leave_one_out();
  const VectorXd mean = operation.rowwise().sum() / static_cast<double>(operation.rows() - 1);
  operation.colwise() -= mean;
  operation.diagonal() += mean;
  return operation;
}

SmootherModes modes_of(const model::SmootherKernel& kernel, const MatrixD& z, const MatrixXd& gram,
                       const ModeLimits& limits, int n_threads) {
  const Smoother smoother(kernel, z);
  const MatrixXd honest = without_own_noise(gram, smoother, kernel);
  const MatrixXd fitted = smoother.covariance * smoother.precision;  // H
  const math::SymmetricEigen eigen = math::symmetric_eigen(fitted * honest * fitted.transpose());
  const Index n = enough_modes(eigen.values.reverse(), limits);

  SmootherModes modes;
  modes.basis = eigen.vectors.rowwise().reverse().leftCols(n).transpose() * fitted;
  if (n > 0) {
    const math::Cholesky products(modes.basis * gram * modes.basis.transpose());
    if (!products.succeeded()) throw NumericalError("kernel smoother: its modes are not independent");
    modes.basis = (products.inverse_factor() * modes.basis).eval();
  }
  modes.targets = honest * modes.basis.transpose();
  if (kernel.antisymmetric || n < 2) return modes;
  modes.own_kernels.resize(std::min(limits.own, static_cast<std::size_t>(n - 1)));
  base::parallel_for(modes.own_kernels.size(), n_threads, [&](std::size_t m, int) {
    modes.own_kernels[m] = fit_mode_kernel(z, modes.targets.col(static_cast<Index>(m)), kernel);
  });
  return modes;
}

}  // namespace elrom::methods
