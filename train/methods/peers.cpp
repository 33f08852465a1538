#include "elrom/methods/peers.hpp"

#include <array>
#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/pod.hpp"
#include "elrom/math/rbf.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/coefficient_models.hpp"
#include "elrom/model/nearest_model.hpp"
#include "elrom/model/pod_model.hpp"
#include "leave_one_out.hpp"
#include "pod_modes.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// What every method sees of the training cases.
struct TrainingInputs {
  math::Standardiser scaler;
  MatrixD standardised;  // (n_cases, n_inputs)
};

TrainingInputs training_inputs(const field::FieldData& data, std::span<const std::size_t> cases) {
  const MatrixD raw = math::take_rows(data.cases->inputs, cases);
  TrainingInputs inputs{math::Standardiser(raw), {}};
  inputs.standardised = inputs.scaler.apply(raw);
  return inputs;
}

/// A peer whose fit() may run on several threads, so folds run side by side.
class Peer : public Method {
 public:
  Peer(std::string name, PeerOptions options) : name_(std::move(name)), options_(std::move(options)) {}
  [[nodiscard]] std::string name() const override { return name_; }
  [[nodiscard]] std::string key(const std::string&) const override {
    return base::digest_of_members(name_, options_);
  }
  [[nodiscard]] MatrixF predict_folds(const field::FieldData& data, const Folds& folds,
                                      std::span<const std::size_t> wanted,
                                      const FitContext& context) const override {
    return predict_by_fitting(*this, data, folds, wanted, context, true);
  }

 protected:
  [[nodiscard]] const PeerOptions& options() const { return options_; }

 private:
  std::string name_;
  PeerOptions options_;
};

class Nearest final : public Peer {
 public:
  using Peer::Peer;
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext&) const override {
    TrainingInputs inputs = training_inputs(data, cases);
    MatrixF values(static_cast<Eigen::Index>(cases.size()), data.values.cols());
    for (std::size_t i = 0; i < cases.size(); ++i) {
      values.row(static_cast<Eigen::Index>(i)) = data.values.row(static_cast<Eigen::Index>(cases[i]));
    }
    return std::make_unique<model::NearestModel>(std::move(inputs.scaler), std::move(inputs.standardised),
                                                 io::Tensor::copy(values), data.cases->mesh.n_columns);
  }
};

/// What predicts the coefficients of the first modes, as many as the model has coefficients.
using Coefficients = std::shared_ptr<const model::CoefficientModel>;

VectorXd squared_columns(const MatrixXd& residuals) {
  return residuals.cwiseAbs2().colwise().sum().transpose();
}

/// POD of the snapshots; what predicts the coefficients, and of how many modes, is the subclass's business.
class PodPeer : public Peer {
 public:
  using Peer::Peer;
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const final {
    math::Pod pod = math::make_pod(data.values, cases, {.n_modes = options().most_modes}, context.n_threads);
    const TrainingInputs inputs = training_inputs(data, cases);
    if (pod.n_modes() == 0) return constant_field(pod.mean, inputs, data.cases->mesh.n_columns);
    const Coefficients coefficients = fit_coefficients(inputs, pod.coefficients, context);
    keep_modes(pod, static_cast<Eigen::Index>(coefficients->n_coefficients()));
    return model::make_pod_model(name(), pod.mean, pod.modes, truncated_deviation(data.values, cases, pod),
                                 data.cases->mesh.n_columns, coefficients);
  }

 protected:
  /// @param coefficients of the training cases, zero mean, (n_cases, n_modes)
  [[nodiscard]] virtual Coefficients fit_coefficients(const TrainingInputs& inputs,
                                                      const MatrixXd& coefficients,
                                                      const FitContext& context) const = 0;

 private:
  /// All cases are equal: one mode of zeros, since a model without modes has nothing to store.
  [[nodiscard]] std::unique_ptr<model::FieldModel> constant_field(const VectorXd& mean,
                                                                  const TrainingInputs& inputs,
                                                                  std::size_t n_columns) const {
    auto none = std::make_shared<model::LinearCoefficients>(
        inputs.scaler, MatrixD::Zero(inputs.scaler.size(), 1), VectorXd::Zero(1), VectorXd::Zero(1));
    return model::make_pod_model(name(), mean, MatrixF::Zero(1, mean.size()), {}, n_columns, std::move(none));
  }
};

class Linear final : public PodPeer {
 public:
  using PodPeer::PodPeer;

 protected:
  [[nodiscard]] Coefficients fit_coefficients(const TrainingInputs& inputs, const MatrixXd& coefficients,
                                              const FitContext&) const override {
    std::vector<double> penalties;
    for (int i = -16; i <= 24; ++i) penalties.push_back(std::pow(10.0, 0.25 * i));
    const math::Ridge all = math::fit_ridge_each(inputs.standardised, coefficients, penalties);
    const Index n = predictable_modes(squared_columns(all.loo_residuals), squared_columns(coefficients));
    MatrixD weights = all.weights.leftCols(n);
    VectorXd intercept = all.intercept.head(n), variance = all.loo_variance.head(n);
    return std::make_shared<model::LinearCoefficients>(inputs.scaler, std::move(weights),
                                                       std::move(intercept), std::move(variance));
  }
};

class Rbf final : public PodPeer {
 public:
  using PodPeer::PodPeer;

 protected:
  [[nodiscard]] Coefficients fit_coefficients(const TrainingInputs& inputs, const MatrixXd& coefficients,
                                              const FitContext&) const override {
    using enum math::RadialFunction;
    const VectorXd energies = squared_columns(coefficients);
    const math::RbfOptions kernels[]{
        {linear, 0, 0}, {linear, 0, 1}, {thin_plate_spline, 0, 1}, {cubic, 0, 1}};
    Smoothed best;
    double least = std::numeric_limits<double>::infinity();
    for (const auto& kernel : kernels) {
      Smoothed smoothed = smooth(kernel, inputs.standardised, coefficients);
      const double error = least_error(smoothed.errors, energies);
      if (error < least || best.errors.size() == 0) {
        least = error;
        best = std::move(smoothed);
      }
    }
    const Index n = predictable_modes(best.errors, energies);
    VectorXd variance = best.errors.head(n) / static_cast<double>(coefficients.rows());
    return std::make_shared<model::RbfCoefficients>(
        inputs.scaler, interpolate(best, inputs.standardised, coefficients.leftCols(n)), std::move(variance));
  }

 private:
  /// One kernel with the best smoothing of each mode.
  struct Smoothed {
    math::RbfOptions kernel;
    std::vector<double> smoothing;
    VectorXd errors;  // summed over cases
  };

  [[nodiscard]] Smoothed smooth(math::RbfOptions kernel, const MatrixD& x, const MatrixXd& y) const {
    constexpr double worst = std::numeric_limits<double>::max();
    Smoothed best{kernel, std::vector<double>(static_cast<std::size_t>(y.cols())),
                  VectorXd::Constant(y.cols(), std::numeric_limits<double>::infinity())};
    for (int decade = 2; decade >= -options().smoothing_decades - 1; --decade) {
      kernel.smoothing = decade < -options().smoothing_decades ? 0 : std::pow(10.0, decade);
      const VectorXd errors = squared_columns(math::rbf_leave_one_out(x, y, kernel));
      for (Index m = 0; m < y.cols(); ++m) {
        const double error = std::isfinite(errors[m]) ? errors[m] : worst;
        if (error >= best.errors[m]) continue;
        best.errors[m] = error;
        best.smoothing[static_cast<std::size_t>(m)] = kernel.smoothing;
      }
    }
    return best;
  }

  [[nodiscard]] static math::RbfInterpolator interpolate(const Smoothed& smoothed, const MatrixD& x,
                                                         const MatrixXd& y) {
    MatrixD weights(x.rows(), y.cols()), tail;
    for (Index m = 0; m < y.cols(); ++m) {
      math::RbfOptions kernel = smoothed.kernel;
      kernel.smoothing = smoothed.smoothing[static_cast<std::size_t>(m)];
      const math::RbfInterpolator one(x, y.col(m), kernel);
      if (m == 0) tail.resize(one.tail().rows(), y.cols());
      weights.col(m) = one.weights().col(0);
      tail.col(m) = one.tail().col(0);
    }
    return {smoothed.kernel.function, x, std::move(weights), std::move(tail)};
  }
};

constexpr std::array covariances{math::Covariance::matern52, math::Covariance::matern32,
                                 math::Covariance::gaussian};

/// The coefficients of the training cases, each over its own deviation.
struct GpTask {
  const MatrixD& inputs;
  VectorXd scale;
  MatrixXd targets;

  GpTask(const MatrixD& x, const MatrixXd& coefficients)
      : inputs(x),
        scale((coefficients.colwise().squaredNorm() / static_cast<double>(coefficients.rows())).cwiseSqrt()),
        targets(coefficients * scale.cwiseInverse().asDiagonal()) {}

  [[nodiscard]] VectorXd energies() const { return scale.cwiseAbs2() * static_cast<double>(targets.rows()); }
  /// Squared leave-one-out error of modes from `first` on, in units of the energies.
  [[nodiscard]] VectorXd errors(const math::GaussianProcess& process, Index first) const {
    const VectorXd squares = squared_columns(process.leave_one_out_residuals());
    return squares.cwiseProduct(scale.segment(first, squares.size()).cwiseAbs2());
  }
};

/// The covariance of the least error(covariance).
template <class Error>
math::Covariance best_covariance(const Error& error) {
  math::Covariance best = covariances.front();
  double least = std::numeric_limits<double>::infinity();
  for (const auto covariance : covariances) {
    const double found = error(covariance);
    if (found < least) {
      least = found;
      best = covariance;
    }
  }
  return best;
}

/// One covariance for all modes, its lengths and noise by the error of the field itself. Not by likelihood:
/// the noise of POD coefficients is the same in every mode, so modes that are nothing but noise (of a smooth
/// field: rounding) would tell the strong ones how noisy they are.
class SharedGp final : public PodPeer {
 public:
  using PodPeer::PodPeer;

 protected:
  [[nodiscard]] Coefficients fit_coefficients(const TrainingInputs& inputs, const MatrixXd& coefficients,
                                              const FitContext&) const override {
    const MatrixD& x = inputs.standardised;
    const Chosen chosen = choose(x, coefficients * coefficients.transpose());
    math::GpParameters parameters{chosen.kernel.lengths, 1, chosen.kernel.noise, chosen.covariance};
    const math::GaussianProcess all(x, coefficients, parameters);
    const MatrixXd residuals = all.leave_one_out_residuals();
    const Index n = predictable_modes(squared_columns(residuals), squared_columns(coefficients));
    const VectorXd scale = signal_of(all, residuals.leftCols(n));
    const MatrixXd targets = coefficients.leftCols(n) * scale.cwiseInverse().asDiagonal();
    return std::make_shared<model::GpCoefficients>(
        inputs.scaler, x, std::vector{math::GaussianProcess(x, targets, std::move(parameters))}, scale);
  }

 private:
  struct Chosen {
    StationaryKernel kernel;
    math::Covariance covariance = covariances.front();
  };
  [[nodiscard]] Chosen choose(const MatrixD& x, const MatrixXd& gram) const {
    std::vector<StationaryKernel> starts;
    for (std::size_t i = 0; i < options().gp_start_lengths.size(); ++i)
      starts.push_back({VectorXd::Constant(1, options().gp_start_lengths[i]), options().gp_start_noises[i]});
    Chosen best{{.error = std::numeric_limits<double>::infinity()}};
    for (const auto covariance : covariances) {
      auto found = fit_stationary_kernel(x, gram, covariance, true, starts);
      if (found.error < best.kernel.error) best = {std::move(found), covariance};
    }
    starts.resize(1);
    starts.push_back(best.kernel);
    auto each = fit_stationary_kernel(x, gram, best.covariance, false, starts);
    if (worth_own_lengths(each.error, best.kernel.error, x)) best.kernel = std::move(each);
    return best;
  }
  /// Schwarz's (1978) criterion of the left-out errors, one datum a case: more lengths always lower the error
  /// that they are fitted to, with few cases and many inputs by following noise.
  [[nodiscard]] static bool worth_own_lengths(double error, double isotropic, const MatrixD& x) {
    const auto n = static_cast<double>(x.rows()), more = static_cast<double>(x.cols() - 1);
    return n * std::log(error) + more * std::log(n) < n * std::log(isotropic);
  }
  /// Deviation of each coefficient's process: the one that makes its errors as large as they are, on average
  /// (Sundararajan & Keerthi 2001).
  [[nodiscard]] static VectorXd signal_of(const math::GaussianProcess& process, const MatrixXd& residuals) {
    const VectorXd precision = process.inverse_factor().colwise().squaredNorm().transpose();
    const VectorXd variance = (precision.asDiagonal() * residuals.cwiseAbs2()).colwise().mean().transpose();
    return variance.cwiseMax(1e-12 * variance.maxCoeff() + 1e-300).cwiseSqrt();
  }
};

class GpPerMode final : public PodPeer {
 public:
  using PodPeer::PodPeer;

 protected:
  [[nodiscard]] Coefficients fit_coefficients(const TrainingInputs& inputs, const MatrixXd& coefficients,
                                              const FitContext& context) const override {
    const GpTask task(inputs.standardised, coefficients);
    const VectorXd energies = task.energies();
    const Index n_chosen_by = std::min<Index>(options().covariance_modes, task.targets.cols());
    const auto covariance = best_covariance([&](math::Covariance kind) {
      const auto processes = fit_modes(task, 0, n_chosen_by, kind, context);
      return errors_of(task, processes).sum();
    });
    std::vector<math::GaussianProcess> processes;
    Index n = 0;
    for (Index begin = 0; begin < task.targets.cols() && (begin == 0 || n > begin - options().mode_block);
         begin += options().mode_block) {
      const Index size = std::min<Index>(options().mode_block, task.targets.cols() - begin);
      for (auto& process : fit_modes(task, begin, size, covariance, context))
        processes.push_back(std::move(process));
      n = predictable_modes(errors_of(task, processes), energies);
    }
    processes.resize(static_cast<std::size_t>(n));
    return std::make_shared<model::GpCoefficients>(inputs.scaler, inputs.standardised, processes,
                                                   task.scale.head(n));
  }

 private:
  [[nodiscard]] math::GaussianProcess fit_process(const MatrixD& inputs, const MatrixXd& targets,
                                                  math::Covariance covariance) const {
    math::GpFitOptions gp{.covariance = covariance,
                          .isotropic = true,
                          .start_lengths = options().gp_start_lengths,
                          .start_noises = options().gp_start_noises,
                          .max_iterations = options().gp_iterations};
    math::GpParameters best = math::fit_gp(inputs, targets, gp);
    const double least = information(inputs, targets, best, 3);
    gp.isotropic = false;
    const auto &lengths = options().gp_start_lengths, &noises = options().gp_start_noises;
    gp.start_lengths = {best.length_scales[0], lengths.front(), lengths.back()};
    gp.start_noises = {best.noise_variance, noises.front(), noises.back()};
    math::GpParameters own = math::fit_gp(inputs, targets, gp);
    if (information(inputs, targets, own, inputs.cols() + 2) < least) best = std::move(own);
    return {inputs, targets, std::move(best)};
  }

  /// Schwarz's (1978) criterion, halved: likelihood alone follows noise once inputs are many.
  [[nodiscard]] static double information(const MatrixD& inputs, const MatrixXd& targets,
                                          const math::GpParameters& parameters, Index n_parameters) {
    VectorXd theta(inputs.cols() + 2), gradient;
    theta << parameters.length_scales.array().log().matrix(), std::log(parameters.signal_variance),
        std::log(parameters.noise_variance);
    const auto n = static_cast<double>(targets.size());
    return n * math::gp_negative_log_likelihood(inputs, targets, parameters.covariance, theta, gradient) +
           0.5 * static_cast<double>(n_parameters) * std::log(n);
  }

  [[nodiscard]] std::vector<math::GaussianProcess> fit_modes(const GpTask& task, Index first, Index n,
                                                             math::Covariance covariance,
                                                             const FitContext& context) const {
    std::vector<math::GaussianProcess> processes(static_cast<std::size_t>(n));
    base::parallel_for(
        processes.size(), context.n_threads,
        [&](std::size_t k, int) {
          processes[k] =
              fit_process(task.inputs, task.targets.col(first + static_cast<Index>(k)), covariance);
        },
        context.stop);
    return processes;
  }

  [[nodiscard]] static VectorXd errors_of(const GpTask& task,
                                          const std::vector<math::GaussianProcess>& processes) {
    VectorXd errors(static_cast<Index>(processes.size()));
    for (Index m = 0; m < errors.size(); ++m)
      errors[m] = task.errors(processes[static_cast<std::size_t>(m)], m)[0];
    return errors;
  }
};

}  // namespace

std::unique_ptr<Method> make_peer(std::string_view name, const PeerOptions& options) {
  const std::string own(name);
  if (own == "nearest") return std::make_unique<Nearest>(own, options);
  if (own == "linear") return std::make_unique<Linear>(own, options);
  if (own == "pod_gp") return std::make_unique<SharedGp>(own, options);
  if (own == "pod_gp_per_mode") return std::make_unique<GpPerMode>(own, options);
  if (own == "pod_rbf") return std::make_unique<Rbf>(own, options);
  throw UsageError(
      {.what = "unknown method '" + own + "'", .advice = base::name_advice(own, closed_form_peers())});
}

}  // namespace elrom::methods
