#include "elrom/methods/peers.hpp"

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/members.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/coefficient_models.hpp"
#include "elrom/model/nearest_model.hpp"
#include "elrom/model/pod_model.hpp"

namespace elrom::methods {

namespace {

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
  [[nodiscard]] MatrixF cross_predict(const field::FieldData& data, const Folds& folds,
                                      const FitContext& context) const override {
    return cross_predict_by_fitting(*this, data, folds, context, true);
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

/// Standard deviation of what the kept modes leave of the training cases, per cell: what varies, less what
/// the modes hold.
VectorXd truncated_deviation(const MatrixF& values, std::span<const std::size_t> cases,
                             const math::Pod& pod) {
  VectorXd variance = math::column_moments(values, cases).deviation.cwiseAbs2();
  for (Eigen::Index m = 0; m < pod.modes.rows(); ++m) {
    variance -= pod.modes.row(m).transpose().cast<double>().cwiseAbs2() *
                (pod.energies[m] / static_cast<double>(cases.size()));
  }
  return variance.cwiseMax(0).cwiseSqrt();
}

/// POD of the snapshots; what predicts the coefficients is the subclass's business.
class PodPeer : public Peer {
 public:
  using Peer::Peer;
  [[nodiscard]] std::unique_ptr<model::FieldModel> fit(const field::FieldData& data,
                                                       std::span<const std::size_t> cases,
                                                       const FitContext& context) const final {
    const math::Pod pod = math::make_pod(data.values, cases, options().truncation, context.n_threads);
    const TrainingInputs inputs = training_inputs(data, cases);
    if (pod.n_modes() == 0) return constant_field(pod.mean, inputs, data.cases->mesh.n_columns);
    return model::make_pod_model(name(), pod.mean, pod.modes, truncated_deviation(data.values, cases, pod),
                                 data.cases->mesh.n_columns,
                                 fit_coefficients(inputs, pod.coefficients, context));
  }

 protected:
  /// @param coefficients of the training cases, zero mean, (n_cases, n_modes)
  [[nodiscard]] virtual std::shared_ptr<const model::CoefficientModel> fit_coefficients(
      const TrainingInputs& inputs, const Eigen::MatrixXd& coefficients, const FitContext& context) const = 0;

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
  [[nodiscard]] std::shared_ptr<const model::CoefficientModel> fit_coefficients(
      const TrainingInputs& inputs, const Eigen::MatrixXd& coefficients, const FitContext&) const override {
    std::vector<double> penalties;
    for (int i = -8; i <= 16; ++i) penalties.push_back(std::pow(10.0, 0.25 * i));
    math::Ridge ridge = math::fit_ridge(inputs.standardised, coefficients, penalties);
    return std::make_shared<model::LinearCoefficients>(
        inputs.scaler, std::move(ridge.weights), std::move(ridge.intercept), std::move(ridge.loo_variance));
  }
};

class Rbf final : public PodPeer {
 public:
  using PodPeer::PodPeer;

 protected:
  [[nodiscard]] std::shared_ptr<const model::CoefficientModel> fit_coefficients(
      const TrainingInputs& inputs, const Eigen::MatrixXd& coefficients, const FitContext&) const override {
    const Eigen::MatrixXd left = math::rbf_leave_one_out(inputs.standardised, coefficients, options().rbf);
    VectorXd variance = left.cwiseAbs2().colwise().mean().transpose();
    return std::make_shared<model::RbfCoefficients>(
        inputs.scaler, math::RbfInterpolator(inputs.standardised, coefficients, options().rbf),
        std::move(variance));
  }
};

class Gp final : public PodPeer {
 public:
  Gp(std::string name, PeerOptions options, bool per_mode)
      : PodPeer(std::move(name), std::move(options)), per_mode_(per_mode) {}

 protected:
  [[nodiscard]] std::shared_ptr<const model::CoefficientModel> fit_coefficients(
      const TrainingInputs& inputs, const Eigen::MatrixXd& coefficients,
      const FitContext& context) const override {
    const VectorXd scale =
        (coefficients.colwise().squaredNorm() / static_cast<double>(coefficients.rows())).cwiseSqrt();
    const Eigen::MatrixXd targets = coefficients * scale.cwiseInverse().asDiagonal();
    const math::GpFitOptions gp{.start_lengths = options().gp_start_lengths,
                                .max_iterations = options().gp_iterations};
    const auto n = static_cast<std::size_t>(per_mode_ ? targets.cols() : 1);
    std::vector<math::GaussianProcess> processes(n);
    base::parallel_for(
        n, context.n_threads,
        [&](std::size_t k, int) {
          const Eigen::MatrixXd own =
              per_mode_ ? Eigen::MatrixXd(targets.col(static_cast<Eigen::Index>(k))) : targets;
          processes[k] =
              math::GaussianProcess(inputs.standardised, own, math::fit_gp(inputs.standardised, own, gp));
        },
        context.stop);
    return std::make_shared<model::GpCoefficients>(inputs.scaler, inputs.standardised, processes, scale);
  }

 private:
  bool per_mode_;
};

}  // namespace

std::unique_ptr<Method> make_peer(std::string_view name, const PeerOptions& options) {
  const std::string own(name);
  if (own == "nearest") return std::make_unique<Nearest>(own, options);
  if (own == "linear") return std::make_unique<Linear>(own, options);
  if (own == "pod_gp") return std::make_unique<Gp>(own, options, false);
  if (own == "pod_gp_per_mode") return std::make_unique<Gp>(own, options, true);
  if (own == "pod_rbf") return std::make_unique<Rbf>(own, options);
  throw UsageError({.what = "unknown method '" + own + "'", .advice = base::name_advice(own, peer_names())});
}

}  // namespace elrom::methods
