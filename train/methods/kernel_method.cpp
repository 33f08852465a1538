#include "elrom/methods/kernel_method.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/pod.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/coefficient_models.hpp"
#include "elrom/model/pod_model.hpp"
#include "elrom/model/smoother_coefficients.hpp"
#include "field_parts.hpp"
#include "leave_one_out.hpp"
#include "shrinkage.hpp"
#include "smoother_modes.hpp"
#include "zones.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What one class of the field becomes in one zone: its modes and what predicts them.
struct ZonePart {
  std::vector<model::SmootherCoefficients::Group> groups;
  Zone zone;
  MatrixF modes;  // weighted, (n_modes, cells of the zone in the domain)
  std::size_t i_class = 0;
  std::vector<double> left_out_variance;  // of each mode, mean over cases of the variance when left out
  [[nodiscard]] bool empty() const { return modes.rows() == 0; }
};

struct ZoneKernel {
  std::size_t i_zone = 0;
  Zone zone;
  model::SmootherKernel kernel;
};

/// What is learned of one class of the field before its modes are made.
struct Learned {
  std::vector<ZoneKernel> zones;  // none: it is better to predict nothing
  MatrixF shrunk;     // the cases, every wavelength and cell as far as it is trusted, (n_cases, n_cells)
  MatrixF residuals;  // (n_cases, n_cells), leave-one-out
};

/// What operations on the cases give, one a zone, together. @param cases (n_cases, n_cells)
/// @param operation_of a zone's kernel: (n, n_cases)
template <class Operation>
MatrixF over_zones(const std::vector<ZoneKernel>& zones, const MatrixF& cases,
                   const Operation& operation_of) {
  MatrixF sum = MatrixF::Zero(cases.rows(), cases.cols());
  for (const ZoneKernel& one : zones)
    one.zone.add(sum, operation_of(one).template cast<float>() * one.zone.part(cases));
  return sum;
}

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
  [[nodiscard]] MatrixF predict_folds(const field::FieldData& data, const Folds& folds,
                                      std::span<const std::size_t> wanted,
                                      const FitContext& context) const override {
    if (context.warm != nullptr) {
      FieldParts field(data, rows_without(folds, folds.size()), context, options_.scale);
      if (field.earlier_kernel(0, 0) != nullptr && !field.nothing_to_learn())
        return predict_at_once(std::move(field), data, folds, wanted, context);
    }
    return predict_by_fitting(*this, data, folds, wanted, context, true);
  }

 private:
  /// Calls take(class, learned) for one class after the other, the symmetric one first.
  template <class Take>
  void learn(FieldParts& field, const field::FieldData& data, std::span<const std::size_t> cases,
             const FitContext& context, const Take& take) const;
  [[nodiscard]] Learned learn_symmetric(MatrixF centred, const FieldParts& field, int n_threads) const;
  [[nodiscard]] Learned learn_antisymmetric(MatrixF values, std::size_t c, const FieldParts& field,
                                            const std::vector<ZoneKernel>& symmetric, int n_threads) const;
  /// Energy that the modes which are left out of one zone may hold.
  [[nodiscard]] double droppable(const MatrixF& residuals, std::size_t n_zones) const {
    return options_.dropped * math::sum_of_squares(residuals) / static_cast<double>(n_zones);
  }
  [[nodiscard]] ModeLimits limits_of(std::size_t c, double may_drop) const {
    const auto most = c == 0 ? options_.most_modes : std::max<std::size_t>(options_.most_modes / 4, 1);
    return {most, options_.own_modes, may_drop};
  }
  [[nodiscard]] MatrixF predict_at_once(FieldParts field, const field::FieldData& data, const Folds& folds,
                                        std::span<const std::size_t> wanted, const FitContext& context) const;

  KernelOptions options_;
};

/// Modes with one kernel, and what the mean variance of each is over cases that are left out.
void add_group(ZonePart& part, const ZoneKernel& of, const model::SmootherKernel& kernel, const MatrixD& z,
               const MatrixXd& targets) {
  const Smoother smoother(kernel, z);
  const MatrixD weights = smoother.precision * targets;
  const VectorXd signal = targets.cwiseProduct(MatrixXd(weights)).colwise().mean().transpose().cwiseMax(0);
  const double variance = std::max(0.0, smoother.precision.diagonal().cwiseInverse().mean() - kernel.noise);
  for (const double one : signal) part.left_out_variance.push_back(one * variance);
  part.groups.push_back({kernel, weights, signal, smoother.inverse_factor.cast<float>(), of.i_zone});
}

ZonePart make_part(const ZoneKernel& of, const MatrixF& shrunk, const MatrixD& z, const ModeLimits& limits,
                   int n_threads) {
  const SmootherModes modes = modes_of(of.kernel, z, of.zone.gram(shrunk, shrunk), limits, n_threads);
  ZonePart part{.zone = of.zone};
  const MatrixF own = of.zone.part(shrunk);
  const auto rows = math::all_rows(static_cast<std::size_t>(own.rows()));
  part.modes = math::combine_rows(modes.basis, own, rows, VectorXd::Zero(own.cols()), n_threads) *
               of.zone.weights.asDiagonal();
  modes.each_group(of.kernel, [&](const model::SmootherKernel& kernel, Index first, Index n) {
    add_group(part, of, kernel, z, modes.targets.middleCols(first, n));
  });
  return part;
}

Learned KernelMethod::learn_symmetric(MatrixF centred, const FieldParts& field, int n_threads) const {
  const auto n = static_cast<double>(centred.rows());
  const auto used = field.features.of_class(0);
  const MatrixD& z = field.features.z;
  Learned learned;
  for (const Zone& zone : zones_of(field.domain, options_.zones))
    learned.zones.push_back({learned.zones.size(), zone, field.start(learned.zones.size())});
  Shrinkage shrinkage(options_.shrink ? field.domain.box(0) : std::nullopt);
  // Deviations of a left-out case are taken from the mean of the others: y_i n / (n - 1) on centred cases.
  const MatrixF truth = centred * static_cast<float>(n / (n - 1));
  const int passes = std::max(options_.passes, 1);
  for (int pass = 1;; ++pass) {
    MatrixF predicted = over_zones(learned.zones, centred, [&](const ZoneKernel& one) {
      return Smoother(one.kernel, z).leave_one_out_about_mean();
    });
    shrinkage.learn(predicted, truth, {}, n_threads);
    learned.residuals = truth - predicted;
    if (pass == passes) break;
    MatrixF trusted = centred;
    shrinkage.apply(trusted, n_threads);
    base::parallel_for(learned.zones.size(), n_threads, [&](std::size_t k, int) {
      auto& [i_zone, zone, kernel] = learned.zones[k];
      const MatrixXd products = zone.gram(centred, trusted);
      if (!(products.trace() > 0)) return;  // nothing varies at these heights
      kernel =
          fit_symmetric_kernel(z, used, 0.5 * (products + products.transpose()), kernel.covariance, &kernel);
    });
  }
  shrinkage.apply(centred, n_threads);
  learned.shrunk = std::move(centred);
  return learned;
}

/// A kernel of an antisymmetric part, and what it leaves of each case that is left out.
struct AntisymmetricFit {
  model::SmootherKernel kernel;
  MatrixXd leave_one_out;
  VectorXd errors;  // squared, summed over the cells, (n_cases)
};

/// The kernel of least leave-one-out error. An asymmetry that lasts, whatever the inputs, breaks the declared
/// symmetry: it is taken only where cases show it beyond chance, by a mean gain of two standard errors.
/// Nothing: it is better to predict no asymmetry at all.
std::optional<AntisymmetricFit> fit_antisymmetry(const KernelFeatures& features, std::size_t c,
                                                 const model::SmootherKernel& symmetric, const MatrixXd& gram,
                                                 const model::SmootherKernel* near) {
  const MatrixD& z = features.z;
  const auto fit_from = [&](const Asymmetry& from) {
    AntisymmetricFit fit{fit_antisymmetric_kernel(z, symmetric, from, gram, near), {}, {}};
    fit.leave_one_out = Smoother(fit.kernel, z).leave_one_out();
    const MatrixXd left = MatrixXd::Identity(z.rows(), z.rows()) - fit.leave_one_out;
    fit.errors = left.cwiseProduct(left * gram).rowwise().sum();
    return fit;
  };
  std::optional<AntisymmetricFit> best;
  VectorXd least = gram.diagonal();
  const auto imbalances = features.of_class(c);
  if (!imbalances.empty()) {
    auto odd = fit_from({.imbalances = imbalances});
    if (odd.errors.sum() < least.sum()) least = odd.errors, best = std::move(odd);
  }
  auto lasting = fit_from({.imbalances = imbalances, .lasting = true});
  if (significance(least - lasting.errors) > 2) best = std::move(lasting);
  return best;
}

Learned KernelMethod::learn_antisymmetric(MatrixF values, std::size_t c, const FieldParts& field,
                                          const std::vector<ZoneKernel>& symmetric, int n_threads) const {
  std::vector<std::optional<AntisymmetricFit>> fits(options_.antisymmetric ? symmetric.size() : 0);
  base::parallel_for(fits.size(), n_threads, [&](std::size_t k, int) {
    const auto& [i_zone, zone, kernel] = symmetric[k];
    const MatrixXd gram = zone.gram(values, values);
    if (gram.trace() > 0)
      fits[k] = fit_antisymmetry(field.features, c, kernel, gram, field.earlier_kernel(c, i_zone));
  });
  Learned learned;
  std::vector<MatrixXd> operations;
  for (std::size_t k = 0; k < fits.size(); ++k) {
    if (!fits[k]) continue;
    learned.zones.push_back({symmetric[k].i_zone, symmetric[k].zone, std::move(fits[k]->kernel)});
    operations.push_back(std::move(fits[k]->leave_one_out));
  }
  if (learned.zones.empty()) return learned.residuals = std::move(values), learned;
  Shrinkage shrinkage(options_.shrink ? field.domain.box(c) : std::nullopt);
  MatrixF predicted = over_zones(learned.zones, values, [&](const ZoneKernel& one) -> const MatrixXd& {
    return operations[static_cast<std::size_t>(&one - learned.zones.data())];
  });
  shrinkage.learn(predicted, values, {.spectral = false, .prior = 0}, n_threads);
  learned.residuals = values - predicted;
  shrinkage.apply(values, n_threads);
  learned.shrunk = std::move(values);
  return learned;
}

template <class Take>
void KernelMethod::learn(FieldParts& field, const field::FieldData& data, std::span<const std::size_t> cases,
                         const FitContext& context, const Take& take) const {
  auto symmetric = learn_symmetric(std::move(field.symmetric), field, context.n_threads);
  const auto zones = symmetric.zones;
  take(std::size_t{0}, std::move(symmetric));
  for (std::size_t c = 1; c < field.classes.size(); ++c) {
    if (context.stop.stop_requested()) throw Interrupted("kernel: stopped");
    take(c, learn_antisymmetric(field.part(data, cases, c, context.n_threads), c, field, zones,
                                context.n_threads));
  }
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

/// The modes of all parts in all cells of the field, and what they are of.
struct AllModes {
  MatrixF modes;  // (n_modes, n_cells)
  std::vector<std::int32_t> class_of;
  std::vector<model::ModePlanes> planes_of;
  std::vector<double> left_out_variance;
};

AllModes together(const std::vector<ZonePart>& parts, const FundamentalDomain& domain, int n_threads) {
  Index n = 0;
  for (const ZonePart& part : parts) n += part.modes.rows();
  AllModes all{MatrixF::Zero(n, static_cast<Index>(domain.n_all_cells())), {}, {}, {}};
  n = 0;
  for (const ZonePart& part : parts) {
    MatrixF own = MatrixF::Zero(part.modes.rows(), static_cast<Index>(domain.n_cells()));
    own.middleCols(part.zone.first_cell, part.modes.cols()) = part.modes;
    domain.add(part.i_class, own, all.modes.middleRows(n, own.rows()), n_threads);
    n += own.rows();
    all.class_of.resize(static_cast<std::size_t>(n), static_cast<std::int32_t>(part.i_class));
    all.planes_of.resize(static_cast<std::size_t>(n), {part.zone.first_plane, part.zone.n_planes});
    std::ranges::copy(part.left_out_variance, std::back_inserter(all.left_out_variance));
  }
  return all;
}

/// Per cell: root of the mean squared residual, less what the coefficients' own variance will add again.
VectorXd residual_deviation(const MatrixF& residuals, const AllModes& all) {
  VectorXd variance = VectorXd::Zero(residuals.cols());
  for (Index i = 0; i < residuals.rows(); ++i)
    variance += residuals.row(i).transpose().cast<double>().cwiseAbs2();
  variance /= static_cast<double>(residuals.rows());
  for (Index m = 0; m < all.modes.rows(); ++m)
    variance -= all.modes.row(m).transpose().cast<double>().cwiseAbs2() *
                all.left_out_variance[static_cast<std::size_t>(m)];
  return variance.cwiseMax(0).cwiseSqrt();
}

std::unique_ptr<model::FieldModel> KernelMethod::fit(const field::FieldData& data,
                                                     std::span<const std::size_t> cases,
                                                     const FitContext& context) const {
  FieldParts field(data, cases, context, options_.scale);
  const VectorXd mean = options_.symmetric ? field.whole_mean() : VectorXd::Zero(data.values.cols());
  if (field.nothing_to_learn()) {
    auto deviation = math::column_moments(data.values, cases).deviation;
    if (!options_.symmetric) deviation.setZero();  // it is the symmetric part's
    return mean_model(data, mean, deviation);
  }

  if (field.scale) context.log->detail("kernel: " + data.info.name + " is learned over " + field.scale->name);
  std::vector<ZonePart> parts;
  MatrixF residuals = MatrixF::Zero(static_cast<Index>(cases.size()), data.values.cols());
  double may_drop = 0;
  learn(field, data, cases, context, [&](std::size_t c, const Learned& learned) {
    if (c == 0) may_drop = droppable(learned.residuals, learned.zones.size());
    if (c == 0 && !options_.symmetric) return;
    field.domain.add(c, learned.residuals, residuals, context.n_threads);
    for (const ZoneKernel& one : learned.zones) {
      auto part = make_part(one, learned.shrunk, field.features.z, limits_of(c, may_drop), context.n_threads);
      part.i_class = c;
      if (!part.empty()) parts.push_back(std::move(part));
    }
  });
  AllModes all = together(parts, field.domain, context.n_threads);
  const VectorXd residual = residual_deviation(residuals, all);
  if (parts.empty() || (options_.symmetric && parts.front().i_class > 0))
    return field.with_scale(mean_model(data, mean, residual));

  std::vector<model::SmootherCoefficients::Group> groups;
  for (ZonePart& part : parts) std::ranges::move(part.groups, std::back_inserter(groups));
  auto coefficients = std::make_shared<model::SmootherCoefficients>(
      field.features.derived.map, field.features.scaler, field.features.z, std::move(groups));
  return field.with_scale(model::make_pod_model("kernel", mean, all.modes, residual,
                                                data.cases->mesh.n_columns, std::move(coefficients),
                                                field.domain.fold(), std::move(all.class_of), all.planes_of));
}

/// Each column less its mean.
MatrixXd about_mean_of_rows(MatrixXd values) {
  values.rowwise() -= values.colwise().mean().eval();
  return values;
}

/// Weights of the training cases in what their modes predict elsewhere, (n, n_cases).
/// @param z_new (n, n_features)
MatrixXd weights_of_cases(const SmootherModes& modes, const model::SmootherKernel& common, const MatrixD& z,
                          const MatrixD& z_new) {
  MatrixXd weights = MatrixXd::Zero(z_new.rows(), z.rows());
  modes.each_group(common, [&](const model::SmootherKernel& kernel, Index first, Index n) {
    const MatrixXd trained = Smoother(kernel, z).precision * modes.targets.middleCols(first, n);
    weights += kernel.matrix(z_new, z) * trained * modes.basis.middleRows(first, n);
  });
  return weights;
}

/// Weights of the other folds' cases in the prediction of each case, 0 for those of its own fold: (n_cases,
/// n_cases).
MatrixXd weights_without_own_fold(const model::SmootherKernel& kernel, const MatrixXd& gram, const MatrixD& z,
                                  const std::vector<std::vector<Index>>& folds, const ModeLimits& limits,
                                  int n_threads) {
  const bool about_mean = !kernel.antisymmetric;
  MatrixXd weights = MatrixXd::Zero(z.rows(), z.rows());
  for (const auto& own : folds) {
    std::vector<Index> others;
    for (Index i = 0; i < z.rows(); ++i)
      if (!std::ranges::binary_search(own, i)) others.push_back(i);
    const MatrixD z_others = z(others, Eigen::all);
    MatrixXd products = gram(others, others);
    if (about_mean) products = math::centred_products(std::move(products));
    const SmootherModes modes = modes_of(kernel, z_others, products, limits, n_threads);
    const MatrixXd found = weights_of_cases(modes, kernel, z_others, z(own, Eigen::all));
    weights(own, others) = about_mean ? about_mean_of_rows(found.transpose()).transpose() : found;
  }
  return weights;
}

/// With an earlier kernel: lengths, noise and trust are learned once, from all cases, and every fold's
/// smoother follows from them in closed form. What those few numbers know of a fold is far below its scatter.
MatrixF KernelMethod::predict_at_once(FieldParts field, const field::FieldData& data, const Folds& folds,
                                      std::span<const std::size_t> wanted, const FitContext& context) const {
  const auto cases = rows_without(folds, folds.size());
  std::vector<std::vector<Index>> places;  // of each wanted fold's rows in `cases`
  for (const auto k : wanted) {
    auto& own = places.emplace_back();
    for (const auto row : folds[k]) own.push_back(std::ranges::lower_bound(cases, row) - cases.begin());
  }
  const auto n = static_cast<Index>(cases.size());
  MatrixF means = MatrixF::Zero(n, field.symmetric.cols());
  for (const auto& own : places) {  // the mean of the others; that of all is 0 here
    const Eigen::RowVectorXf others = field.symmetric(own, Eigen::all).colwise().sum() /
                                      -static_cast<float>(n - static_cast<Index>(own.size()));
    for (const Index i : own) means.row(i) = field.mean.transpose().cast<float>() + others;
  }
  MatrixF found = MatrixF::Zero(n, data.values.cols());
  if (options_.symmetric) field.domain.add(0, means, found, context.n_threads);
  double may_drop = 0;
  learn(field, data, cases, context, [&](std::size_t c, const Learned& learned) {
    if (learned.zones.empty()) return;
    if (c == 0) may_drop = droppable(learned.residuals, learned.zones.size());
    if (c == 0 && !options_.symmetric) return;
    const MatrixF departures = over_zones(learned.zones, learned.shrunk, [&](const ZoneKernel& one) {
      const MatrixXd gram = one.zone.gram(learned.shrunk, learned.shrunk);
      return weights_without_own_fold(one.kernel, gram, field.features.z, places, limits_of(c, may_drop),
                                      context.n_threads);
    });
    field.domain.add(c, departures, found, context.n_threads);
  });
  MatrixF predictions = MatrixF::Zero(data.values.rows(), data.values.cols());
  for (const auto& own : places) {
    for (const Index i : own)
      predictions.row(static_cast<Index>(cases[static_cast<std::size_t>(i)])) =
          found.row(i) * static_cast<float>(field.scales[i]);
  }
  return predictions;
}

}  // namespace

std::unique_ptr<Method> make_kernel_method(const KernelOptions& options) {
  return std::make_unique<KernelMethod>(options);
}

}  // namespace elrom::methods
