#include "elrom/methods/kernel_method.hpp"

#include <algorithm>
#include <cmath>

#include "derived_inputs.hpp"
#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/pod.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/coefficient_models.hpp"
#include "elrom/model/pod_model.hpp"
#include "elrom/model/smoother_coefficients.hpp"
#include "leave_one_out.hpp"
#include "shrinkage.hpp"
#include "symmetry_classes.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// A B^T in double, over blocks of cells.
MatrixXd cross_gram(const MatrixF& a, const MatrixF& b) {
  constexpr Index block = 1024;
  MatrixXd gram = MatrixXd::Zero(a.rows(), b.rows());
  for (Index begin = 0; begin < a.cols(); begin += block) {
    const Index n = std::min(block, a.cols() - begin);
    const MatrixD left = a.middleCols(begin, n).cast<double>(), right = b.middleCols(begin, n).cast<double>();
    gram += left * right.transpose();
  }
  return gram;
}

/// What one class of the field becomes: its modes, what predicts them, and the leave-one-out residuals.
struct SymmetryPart {
  model::SmootherCoefficients::Group group;
  MatrixF modes;      // (n_modes, n_cells)
  MatrixF residuals;  // (n_cases, n_cells)
  std::size_t i_class = 0;
  double left_out_variance =
      0;  // mean over cases of the latent variance when left out, in units of the signal
  [[nodiscard]] bool empty() const { return modes.rows() == 0; }
};

/// The smoother of one covariance on the training cases.
struct Smoother {
  MatrixXd covariance, precision, inverse_factor;  // K, (K + noise I)^-1, L^-1

  Smoother(const model::SmootherKernel& kernel, const MatrixD& z) : covariance(kernel.matrix(z, z)) {
    MatrixXd k = covariance;
    k.diagonal().array() += kernel.noise;
    const math::Cholesky factor(k);
    if (!factor.succeeded()) throw NumericalError("kernel smoother: the covariance is not positive definite");
    precision = factor.inverse();
    inverse_factor = factor.inverse_factor();
  }

  /// Rows predict each case from the others: I - diag(P)^-1 P.
  [[nodiscard]] MatrixXd leave_one_out() const {
    MatrixXd operation = -(precision.diagonal().cwiseInverse().asDiagonal() * precision);
    operation.diagonal().array() += 1;
    return operation;
  }
};

class KernelMethod final : public Method {
 public:
  explicit KernelMethod(KernelOptions options) : options_(options) {}
  [[nodiscard]] std::string name() const override { return "kernel"; }
  [[nodiscard]] std::string key(const std::string&) const override {
    return base::digest_of_members(name(), options_);
  }
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const override;
  [[nodiscard]] MatrixF cross_predict(const field::FieldData& data, const Folds& folds,
                                      const FitContext& context) const override {
    return cross_predict_by_fitting(*this, data, folds, context, true);
  }

 private:
  [[nodiscard]] SymmetryPart fit_symmetric(MatrixF centred, const MatrixD& z, const std::vector<Index>& used,
                                           const field::FieldData& data, int n_threads) const;
  [[nodiscard]] SymmetryPart fit_antisymmetric(MatrixF values, const MatrixD& z,
                                               const std::vector<Index>& imbalances,
                                               const model::SmootherKernel& symmetric, double may_drop,
                                               const field::FieldData& data, int n_threads) const;
  static void make_modes(SymmetryPart& part, const Smoother& smoother, const MatrixF& shrunk,
                         std::size_t most_modes, double may_drop);

  KernelOptions options_;
};

/// Basis of what the smoother can say: the principal directions of the fitted (not the noisy) cases.
/// @param may_drop energy, summed over cases and cells, that the left-out directions may hold
void KernelMethod::make_modes(SymmetryPart& part, const Smoother& smoother, const MatrixF& shrunk,
                              std::size_t most_modes, double may_drop) {
  const MatrixXd gram = cross_gram(shrunk, shrunk);
  const MatrixXd fitted = smoother.covariance * smoother.precision;  // H
  const MatrixD fitted_gram = fitted * gram * fitted.transpose();
  const math::SymmetricEigen eigen = math::symmetric_eigen(fitted_gram);
  const VectorXd energies = eigen.values.reverse().cwiseMax(0);
  const double total = energies.sum();
  Index n = 0;
  double left = total;
  while (n < energies.size() && n < static_cast<Index>(most_modes) && energies[n] > 1e-13 * total &&
         left > may_drop) {
    left -= energies[n++];
  }
  const MatrixXd directions = eigen.vectors.rowwise().reverse().leftCols(n) *
                              energies.head(n).cwiseSqrt().cwiseInverse().asDiagonal();
  const MatrixXd basis = directions.transpose() * fitted;  // modes = basis * shrunk
  const auto rows = math::all_rows(static_cast<std::size_t>(shrunk.rows()));
  part.modes = math::combine_rows(basis, shrunk, rows, VectorXd::Zero(shrunk.cols()));
  const MatrixXd coefficients = gram * basis.transpose();  // of the shrunk cases, (n_cases, n_modes)
  part.group.weights = smoother.precision * coefficients;
  part.group.signal =
      coefficients.cwiseProduct(MatrixXd(part.group.weights)).colwise().mean().transpose().cwiseMax(0);
  part.group.inverse_factor = smoother.inverse_factor.cast<float>();
  part.left_out_variance =
      std::max(0.0, smoother.precision.diagonal().cwiseInverse().mean() - part.group.kernel.noise);
}

SymmetryPart KernelMethod::fit_symmetric(MatrixF centred, const MatrixD& z, const std::vector<Index>& used,
                                         const field::FieldData& data, int n_threads) const {
  const auto n = static_cast<double>(centred.rows());
  MatrixXd gram = cross_gram(centred, centred);
  SymmetryPart part;
  Shrinkage shrinkage(options_.shrink ? box_of(data.cases->mesh) : std::nullopt);
  // Deviations of a left-out case are taken from the mean of the others: y_i n / (n - 1) on centred cases.
  const MatrixF truth = centred * static_cast<float>(n / (n - 1));
  for (int pass = 0; pass < std::max(options_.passes, 1); ++pass) {
    part.group.kernel = fit_symmetric_kernel(z, used, gram);
    MatrixXd left_out = Smoother(part.group.kernel, z).leave_one_out();
    left_out.array() += 1 / (n - 1);
    left_out.diagonal().array() -= 1 / (n - 1);
    MatrixF predicted = left_out.cast<float>() * centred;
    shrinkage.learn(predicted, truth, {}, n_threads);
    part.residuals = truth - predicted;
    if (pass + 1 < options_.passes) {
      MatrixF weighted = centred;
      shrinkage.apply(weighted, n_threads);
      gram = cross_gram(centred, weighted);
      gram = (0.5 * (gram + gram.transpose())).eval();
    }
  }
  shrinkage.apply(centred, n_threads);
  make_modes(part, Smoother(part.group.kernel, z), centred, options_.most_modes,
             options_.dropped * math::sum_of_squares(part.residuals));
  return part;
}

SymmetryPart KernelMethod::fit_antisymmetric(MatrixF values, const MatrixD& z,
                                             const std::vector<Index>& imbalances,
                                             const model::SmootherKernel& symmetric, double may_drop,
                                             const field::FieldData& data, int n_threads) const {
  SymmetryPart part;
  const MatrixXd gram = cross_gram(values, values);
  if (imbalances.empty() || !(gram.trace() > 0)) return part.residuals = std::move(values), part;
  part.group.kernel = fit_antisymmetric_kernel(z, symmetric, imbalances, gram);
  const Smoother smoother(part.group.kernel, z);
  if (leave_one_out_error(smoother.covariance, part.group.kernel.noise, gram) >= gram.trace()) {
    return part.residuals = std::move(values), part;  // better to predict no asymmetry at all
  }
  Shrinkage shrinkage(options_.shrink ? box_of(data.cases->mesh) : std::nullopt);
  MatrixF predicted = smoother.leave_one_out().cast<float>() * values;
  shrinkage.learn(predicted, values, {.spectral = false, .prior = 0}, n_threads);
  part.residuals = values - predicted;
  shrinkage.apply(values, n_threads);
  make_modes(part, smoother, values, std::max<std::size_t>(options_.most_modes / 4, 1), may_drop);
  return part;
}

struct Features {
  DerivedInputs derived;
  math::Standardiser scaler;  // imbalances keep their zero: mean 0, root mean square as scale
  MatrixD z;

  [[nodiscard]] std::vector<Index> of_class(std::size_t c) const {
    std::vector<Index> found;
    for (std::size_t j = 0; j < derived.class_of.size(); ++j) {
      if (derived.class_of[j] == c) found.push_back(static_cast<Index>(j));
    }
    return found;
  }
};

Features features_of(const field::CaseSet& cases, std::span<const std::size_t> rows,
                     const std::vector<SymmetryClass>& classes) {
  Features features{derive_inputs(cases, rows, classes), {}, {}};
  MatrixD raw(static_cast<Index>(rows.size()), static_cast<Index>(features.derived.map.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = cases.inputs.row(static_cast<Index>(rows[i]));
    auto out = raw.row(static_cast<Index>(i));
    features.derived.map.evaluate({row.data(), static_cast<std::size_t>(row.size())},
                                  {out.data(), static_cast<std::size_t>(out.size())});
  }
  math::ColumnMoments moments = math::column_moments(raw);
  for (Index j = 0; j < raw.cols(); ++j) {
    if (features.derived.class_of[static_cast<std::size_t>(j)] == 0) continue;
    moments.mean[j] = 0;
    moments.deviation[j] = std::sqrt(raw.col(j).squaredNorm() / static_cast<double>(raw.rows()));
  }
  features.scaler = math::Standardiser(moments.mean, moments.deviation);
  features.z = features.scaler.apply(raw);
  return features;
}

/// Per cell: root of the mean squared residual, less what the coefficients' own variance will add again.
VectorXd residual_deviation(const MatrixF& residuals, const std::vector<SymmetryPart>& parts) {
  VectorXd variance = VectorXd::Zero(residuals.cols());
  for (Index i = 0; i < residuals.rows(); ++i)
    variance += residuals.row(i).transpose().cast<double>().cwiseAbs2();
  variance /= static_cast<double>(residuals.rows());
  for (const SymmetryPart& part : parts) {
    for (Index m = 0; m < part.modes.rows(); ++m) {
      variance -= part.modes.row(m).transpose().cast<double>().cwiseAbs2() *
                  (part.group.signal[m] * part.left_out_variance);
    }
  }
  return variance.cwiseMax(0).cwiseSqrt();
}

/// Nothing varies, or nothing that varies is known: the mean alone, as one mode of zeros.
std::unique_ptr<model::FieldModel> mean_model(const field::FieldData& data, const VectorXd& mean,
                                              const VectorXd& residual) {
  const Index n = data.cases->inputs.cols();
  auto none =
      std::make_shared<model::LinearCoefficients>(math::Standardiser(VectorXd::Zero(n), VectorXd::Ones(n)),
                                                  MatrixD::Zero(n, 1), VectorXd::Zero(1), VectorXd::Zero(1));
  return model::make_pod_model("kernel", mean, MatrixF::Zero(1, mean.size()), residual,
                               data.cases->mesh.n_columns, std::move(none));
}

MatrixF stacked(const std::vector<SymmetryPart>& parts, Index n_cells) {
  Index n = 0;
  for (const SymmetryPart& part : parts) n += part.modes.rows();
  MatrixF modes(n, n_cells);
  n = 0;
  for (const SymmetryPart& part : parts) {
    modes.middleRows(n, part.modes.rows()) = part.modes;
    n += part.modes.rows();
  }
  return modes;
}

std::unique_ptr<model::FieldModel> KernelMethod::fit(const field::FieldData& data,
                                                     std::span<const std::size_t> cases,
                                                     const FitContext& context) const {
  const int threads = context.n_threads;
  const std::vector<SymmetryClass> classes = symmetry_classes(data.cases->mirrors.size());
  MatrixF symmetric = project(data, cases, classes.front(), threads);
  const VectorXd mean = math::row_mean(symmetric, math::all_rows(cases.size()), threads);
  for (Index i = 0; i < symmetric.rows(); ++i) symmetric.row(i) -= mean.transpose().cast<float>();
  const Features features = features_of(*data.cases, cases, classes);
  const std::vector<Index> used = features.of_class(0);
  if (cases.size() < 3 || used.empty() || !(symmetric.squaredNorm() > 0)) {
    return mean_model(data, mean, math::column_moments(data.values, cases).deviation);
  }

  std::vector<SymmetryPart> parts{fit_symmetric(std::move(symmetric), features.z, used, data, threads)};
  MatrixF residuals = std::move(parts.front().residuals);
  const double may_drop = options_.dropped * math::sum_of_squares(residuals);
  for (std::size_t c = 1; c < classes.size(); ++c) {
    if (context.stop.stop_requested()) throw Interrupted("kernel: stopped");
    MatrixF values = project(data, cases, classes[c], threads);
    if (!options_.antisymmetric) {
      residuals += values;
      continue;
    }
    SymmetryPart part = fit_antisymmetric(std::move(values), features.z, features.of_class(c),
                                          parts.front().group.kernel, may_drop, data, threads);
    residuals += part.residuals;
    part.residuals.resize(0, 0);
    part.i_class = c;
    if (!part.empty()) parts.push_back(std::move(part));
  }
  const VectorXd residual = residual_deviation(residuals, parts);
  if (parts.front().empty()) return mean_model(data, mean, residual);

  std::vector<model::SmootherCoefficients::Group> groups;
  const MatrixF modes = stacked(parts, data.values.cols());
  std::vector<std::int32_t> class_of_mode;
  for (const SymmetryPart& part : parts) {
    class_of_mode.insert(class_of_mode.end(), static_cast<std::size_t>(part.modes.rows()),
                         static_cast<std::int32_t>(part.i_class));
  }
  std::vector<std::vector<int>> signs;
  for (const SymmetryClass& one : classes) signs.push_back(one.signs);
  const field::Mesh& mesh = data.cases->mesh;
  model::SymmetryFold fold(data.cases->mirrors, data.info.parity, signs, mesh.n_planes, mesh.n_columns);
  for (SymmetryPart& part : parts) groups.push_back(std::move(part.group));
  auto coefficients = std::make_shared<model::SmootherCoefficients>(features.derived.map, features.scaler,
                                                                    features.z, std::move(groups));
  return model::make_pod_model("kernel", mean, modes, residual, mesh.n_columns, std::move(coefficients),
                               std::move(fold), std::move(class_of_mode));
}

}  // namespace

std::unique_ptr<Method> make_kernel_method(const KernelOptions& options) {
  return std::make_unique<KernelMethod>(options);
}

}  // namespace elrom::methods
