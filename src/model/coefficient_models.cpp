#include "elrom/model/coefficient_models.hpp"

#include <array>
#include <cmath>

#include "elrom/base/error.hpp"
#include "model_parts.hpp"

namespace elrom::model {

namespace {

using Eigen::Map;
using Eigen::RowVectorXd;
using Eigen::VectorXd;

std::span<const double> scale_inputs(const math::Standardiser& scaler, std::span<const double> inputs,
                                     Workspace& workspace) {
  const std::span<double> scaled = doubles(workspace, inputs.size());
  scaler.apply(inputs, scaled);
  return scaled;
}

void copy_variance(const VectorXd& from, std::span<double> to) {
  if (!to.empty()) VectorXd::Map(to.data(), from.size()) = from;
}

}  // namespace

LinearCoefficients::LinearCoefficients(math::Standardiser scaler, MatrixD weights, VectorXd intercept,
                                       VectorXd variance)
    : scaler_(std::move(scaler)),
      weights_(std::move(weights)),
      intercept_(std::move(intercept)),
      variance_(std::move(variance)) {
  check(scaler_.size() == weights_.rows() && intercept_.size() == weights_.cols() &&
            variance_.size() == weights_.cols(),
        "linear coefficients: shapes");
}

void LinearCoefficients::predict(std::span<const double> inputs, std::span<double> coefficients,
                                 std::span<double> variance, bool, Workspace& workspace) const {
  const Workspace::Frame frame(workspace);
  const std::span<const double> x = scale_inputs(scaler_, inputs, workspace);
  Map<RowVectorXd> out(coefficients.data(), weights_.cols());
  out = intercept_.transpose();
  for (Eigen::Index i = 0; i < weights_.rows(); ++i) out += x[static_cast<std::size_t>(i)] * weights_.row(i);
  copy_variance(variance_, variance);
}

void LinearCoefficients::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", kind()}}.dump());
  save_scaler(file, prefix + "/scaler", scaler_);
  file.set(prefix + "/weights", io::Tensor::copy(weights_));
  save_vector(file, prefix + "/intercept", intercept_);
  save_vector(file, prefix + "/variance", variance_);
}

std::unique_ptr<CoefficientModel> LinearCoefficients::load(const io::TensorFile& file,
                                                           const std::string& prefix) {
  math::Standardiser scaler = load_scaler(file, prefix + "/scaler");
  MatrixD weights =
      load_matrix(file, prefix + "/weights", static_cast<std::size_t>(scaler.size()), io::any_size);
  const auto n = static_cast<std::size_t>(weights.cols());
  VectorXd intercept = load_vector(file, prefix + "/intercept", n),
           variance = load_vector(file, prefix + "/variance", n);
  return std::make_unique<LinearCoefficients>(std::move(scaler), std::move(weights), std::move(intercept),
                                              std::move(variance));
}

GpCoefficients::GpCoefficients(math::Standardiser scaler, const MatrixD& inputs,
                               const std::vector<math::GaussianProcess>& processes, const VectorXd& scale)
    : scaler_(std::move(scaler)), inputs_(inputs), scale_(scale) {
  const auto n_kernels = static_cast<Eigen::Index>(processes.size()), n_cases = inputs.rows();
  check(n_kernels == 1 || n_kernels == scale.size(), "Gaussian processes: one, or one for each coefficient");
  covariance_ = processes.front().parameters().covariance;
  lengths_.resize(n_kernels, inputs.cols());
  signal_.resize(n_kernels);
  weights_.resize(n_cases, scale.size());
  std::vector<float> factors(static_cast<std::size_t>(n_kernels * n_cases * n_cases));
  for (Eigen::Index k = 0; k < n_kernels; ++k) {
    const math::GaussianProcess& process = processes[static_cast<std::size_t>(k)];
    lengths_.row(k) = process.parameters().length_scales.transpose();
    signal_[k] = process.parameters().signal_variance;
    if (n_kernels == 1) {
      weights_ = process.weights() * scale.asDiagonal();
    } else {
      weights_.col(k) = process.weights().col(0) * scale[k];
    }
    MapF(factors.data() + k * n_cases * n_cases, n_cases, n_cases) = process.inverse_factor().cast<float>();
  }
  const auto n = static_cast<std::size_t>(n_cases);
  inverse_factor_ = io::Tensor::copy(std::span<const float>(factors), {processes.size(), n, n});
}

void GpCoefficients::kernel_row(std::size_t i_kernel, std::span<const double> scaled,
                                std::span<double> k) const {
  const auto row = static_cast<Eigen::Index>(i_kernel);
  for (Eigen::Index i = 0; i < inputs_.rows(); ++i) {
    double squares = 0;
    for (Eigen::Index j = 0; j < inputs_.cols(); ++j) {
      const double d = (scaled[static_cast<std::size_t>(j)] - inputs_(i, j)) / lengths_(row, j);
      squares += d * d;
    }
    k[static_cast<std::size_t>(i)] = signal_[row] * math::covariance(covariance_, std::sqrt(squares));
  }
}

void GpCoefficients::predict(std::span<const double> inputs, std::span<double> coefficients,
                             std::span<double> variance, bool, Workspace& workspace) const {
  const Workspace::Frame frame(workspace);
  const std::span<const double> x = scale_inputs(scaler_, inputs, workspace);
  const auto n_cases = static_cast<std::size_t>(inputs_.rows()),
             n_kernels = static_cast<std::size_t>(lengths_.rows());
  const std::span<double> k = doubles(workspace, n_cases);
  const Map<const VectorXd> k_vector(k.data(), inputs_.rows());
  for (std::size_t i_kernel = 0; i_kernel < n_kernels; ++i_kernel) {
    kernel_row(i_kernel, x, k);
    const Eigen::Index first = n_kernels == 1 ? 0 : static_cast<Eigen::Index>(i_kernel);
    const Eigen::Index n = n_kernels == 1 ? weights_.cols() : 1;
    for (Eigen::Index m = first; m < first + n; ++m)
      coefficients[static_cast<std::size_t>(m)] = k_vector.dot(weights_.col(m));
    if (variance.empty()) continue;

    const ConstMapF factor(inverse_factor_.f32().data() + i_kernel * n_cases * n_cases, inputs_.rows(),
                           inputs_.rows());
    double explained = 0;
    for (Eigen::Index i = 0; i < factor.rows(); ++i) {
      double part = 0;  // row i of a lower triangular matrix
      for (Eigen::Index j = 0; j <= i; ++j) part += static_cast<double>(factor(i, j)) * k_vector[j];
      explained += part * part;
    }
    const double left = std::max(0.0, signal_[static_cast<Eigen::Index>(i_kernel)] - explained);
    for (Eigen::Index m = first; m < first + n; ++m)
      variance[static_cast<std::size_t>(m)] = left * scale_[m] * scale_[m];
  }
}

void GpCoefficients::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(
      prefix,
      nlohmann::json{{"kind", kind()}, {"covariance", std::string(math::name_of(covariance_))}}.dump());
  save_scaler(file, prefix + "/scaler", scaler_);
  file.set(prefix + "/inputs", io::Tensor::copy(inputs_));
  file.set(prefix + "/lengths", io::Tensor::copy(lengths_));
  save_vector(file, prefix + "/signal", signal_);
  file.set(prefix + "/weights", io::Tensor::copy(weights_));
  save_vector(file, prefix + "/scale", scale_);
  file.set(prefix + "/inverse_factor", inverse_factor_);
}

std::unique_ptr<CoefficientModel> GpCoefficients::load(const io::TensorFile& file,
                                                       const std::string& prefix) {
  const std::string where = file.where() + ":" + prefix;
  std::unique_ptr<GpCoefficients> model(new GpCoefficients());
  model->covariance_ = math::covariance_of(text_of(read_description(file, prefix), "covariance", where));
  model->scaler_ = load_scaler(file, prefix + "/scaler");
  const auto n_inputs = static_cast<std::size_t>(model->scaler_.size());
  model->inputs_ = load_matrix(file, prefix + "/inputs", io::any_size, n_inputs);
  model->lengths_ = load_matrix(file, prefix + "/lengths", io::any_size, n_inputs);
  const auto n_cases = static_cast<std::size_t>(model->inputs_.rows()),
             n_kernels = static_cast<std::size_t>(model->lengths_.rows());
  model->signal_ = load_vector(file, prefix + "/signal", n_kernels);
  model->weights_ = load_matrix(file, prefix + "/weights", n_cases, io::any_size);
  model->scale_ = load_vector(file, prefix + "/scale", static_cast<std::size_t>(model->weights_.cols()));
  const std::array<std::size_t, 3> shape{n_kernels, n_cases, n_cases};
  model->inverse_factor_ = file.tensor(prefix + "/inverse_factor", shape);
  static_cast<void>(model->inverse_factor_.f32());
  if (n_kernels == 0 || n_cases == 0 || (n_kernels != 1 && n_kernels != model->n_coefficients())) {
    throw InputError(
        {.what = "Gaussian processes do not fit the coefficients",
         .where = where,
         .found = std::to_string(n_kernels) + " processes of " + std::to_string(n_cases) + " cases",
         .expected = "1 or " + std::to_string(model->n_coefficients()) + " of at least one case"});
  }
  return model;
}

RbfCoefficients::RbfCoefficients(math::Standardiser scaler, math::RbfInterpolator interpolator,
                                 VectorXd variance)
    : scaler_(std::move(scaler)), interpolator_(std::move(interpolator)), variance_(std::move(variance)) {
  check(interpolator_.points().cols() == scaler_.size() && interpolator_.weights().cols() == variance_.size(),
        "RBF coefficients: shapes");
}

void RbfCoefficients::predict(std::span<const double> inputs, std::span<double> coefficients,
                              std::span<double> variance, bool, Workspace& workspace) const {
  const Workspace::Frame frame(workspace);
  interpolator_.evaluate(scale_inputs(scaler_, inputs, workspace), coefficients);
  copy_variance(variance_, variance);
}

void RbfCoefficients::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", kind()},
                                       {"function", std::string(math::name_of(interpolator_.function()))}}
                            .dump());
  save_scaler(file, prefix + "/scaler", scaler_);
  file.set(prefix + "/inputs", io::Tensor::copy(interpolator_.points()));
  file.set(prefix + "/weights", io::Tensor::copy(interpolator_.weights()));
  file.set(prefix + "/tail", io::Tensor::copy(interpolator_.tail()));
  save_vector(file, prefix + "/variance", variance_);
}

std::unique_ptr<CoefficientModel> RbfCoefficients::load(const io::TensorFile& file,
                                                        const std::string& prefix) {
  const std::string where = file.where() + ":" + prefix;
  const auto function = math::radial_function_of(text_of(read_description(file, prefix), "function", where));
  math::Standardiser scaler = load_scaler(file, prefix + "/scaler");
  MatrixD points =
      load_matrix(file, prefix + "/inputs", io::any_size, static_cast<std::size_t>(scaler.size()));
  MatrixD weights =
      load_matrix(file, prefix + "/weights", static_cast<std::size_t>(points.rows()), io::any_size);
  MatrixD tail = load_matrix(file, prefix + "/tail", io::any_size, static_cast<std::size_t>(weights.cols()));
  VectorXd variance = load_vector(file, prefix + "/variance", static_cast<std::size_t>(weights.cols()));
  if (tail.rows() != 1 && tail.rows() != 1 + scaler.size()) {
    throw InputError({.what = "tail of radial basis functions of the wrong size",
                      .where = where,
                      .found = std::to_string(tail.rows()) + " terms",
                      .expected = "1 or " + std::to_string(1 + scaler.size())});
  }
  return std::make_unique<RbfCoefficients>(
      std::move(scaler),
      math::RbfInterpolator(function, std::move(points), std::move(weights), std::move(tail)),
      std::move(variance));
}

}  // namespace elrom::model
