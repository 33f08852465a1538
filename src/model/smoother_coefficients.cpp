#include "elrom/model/smoother_coefficients.hpp"

#include <array>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/math/kernel.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "model_parts.hpp"

namespace elrom::model {

namespace {

constexpr std::size_t most_groups = 256;

nlohmann::json to_json(const SmootherKernel& kernel) {
  return {{"antisymmetric", kernel.antisymmetric},
          {"covariance", math::name_of(kernel.covariance)},
          {"linear", kernel.linear},
          {"constant", kernel.constant},
          {"noise", kernel.noise}};
}

SmootherKernel kernel_of(const nlohmann::json& json, const std::string& where) {
  SmootherKernel kernel;
  try {
    kernel.antisymmetric = json.at("antisymmetric").get<bool>();
    if (json.contains("covariance"))  // a bundle without it is of the time before there was a choice
      kernel.covariance = math::covariance_of(json.at("covariance").get<std::string>());
    kernel.linear = json.at("linear").get<double>();
    kernel.constant = json.at("constant").get<double>();
    kernel.noise = json.at("noise").get<double>();
  } catch (const nlohmann::json::exception& error) {
    throw InputError({.what = "broken description of a covariance", .where = where, .found = error.what()});
  }
  return kernel;
}

}  // namespace

double SmootherKernel::operator()(const double* z, const double* z_other) const {
  double squares = 0, dot = 0, product = 0;
  for (Eigen::Index j = 0; j < inverse_lengths.size(); ++j) {
    const double a = z[j] * inverse_lengths[j], b = z_other[j] * inverse_lengths[j];
    squares += (a - b) * (a - b);
    dot += a * b;
    product += z[j] * z_other[j] * imbalance[j] * imbalance[j];
  }
  const double near = math::covariance(covariance, std::sqrt(squares));
  return antisymmetric ? (product + constant) * (linear + near) : near + linear * dot + constant;
}

Eigen::MatrixXd SmootherKernel::matrix(const MatrixD& z, const MatrixD& z_other) const {
  Eigen::MatrixXd k(z.rows(), z_other.rows());
  for (Eigen::Index j = 0; j < z_other.rows(); ++j) {
    for (Eigen::Index i = 0; i < z.rows(); ++i) k(i, j) = (*this)(z.row(i).data(), z_other.row(j).data());
  }
  return k;
}

SmootherCoefficients::SmootherCoefficients(FeatureMap features, math::Standardiser scaler, MatrixD z,
                                           std::vector<Group> groups)
    : features_(std::move(features)),
      scaler_(std::move(scaler)),
      z_(std::move(z)),
      groups_(std::move(groups)) {
  const auto n_features = static_cast<Eigen::Index>(features_.size());
  bool fits = scaler_.size() == n_features && z_.cols() == n_features;
  for (const Group& group : groups_) {
    fits = fits && group.weights.rows() == z_.rows() && group.signal.size() == group.weights.cols() &&
           group.inverse_factor.rows() == z_.rows() && group.inverse_factor.cols() == z_.rows() &&
           group.kernel.inverse_lengths.size() == n_features && group.kernel.imbalance.size() == n_features;
    n_coefficients_ += static_cast<std::size_t>(group.weights.cols());
  }
  if (!fits) throw InputError("parts of a kernel smoother do not fit together");
}

MatrixD SmootherCoefficients::coefficients_of_cases() const {
  MatrixD all(z_.rows(), static_cast<Eigen::Index>(n_coefficients_));
  Eigen::Index first = 0;
  for (const Group& group : groups_) {
    all.middleCols(first, group.weights.cols()) =
        group.kernel.matrix(z_, z_) * group.weights + group.kernel.noise * group.weights;
    first += group.weights.cols();
  }
  return all;
}

SmootherCoefficients::Changed SmootherCoefficients::of_other_cases(MatrixD z, const MatrixD& cases) const {
  Changed changed{nullptr, Eigen::VectorXd::Zero(cases.cols())};
  std::vector<Group> groups;
  Eigen::Index first = 0;
  for (const Group& group : groups_) {
    MatrixD own = cases.middleCols(first, group.weights.cols());
    if (!group.kernel.antisymmetric) {
      const Eigen::RowVectorXd mean = own.colwise().mean();
      own.rowwise() -= mean;
      changed.mean_shift.segment(first, mean.size()) = mean.transpose();
    }
    Eigen::MatrixXd covariance = group.kernel.matrix(z, z);
    covariance.diagonal().array() += group.kernel.noise;
    const math::Cholesky factor(covariance);
    if (!factor.succeeded()) throw NumericalError("kernel smoother: the covariance is not positive definite");
    groups.push_back(
        {group.kernel, factor.solve(own), group.signal, factor.inverse_factor().cast<float>(), group.zone});
    first += group.weights.cols();
  }
  changed.coefficients =
      std::make_shared<SmootherCoefficients>(features_, scaler_, std::move(z), std::move(groups));
  return changed;
}

SmootherCoefficients::Changed SmootherCoefficients::without_case(std::size_t i_case) const {
  const auto left_out = static_cast<Eigen::Index>(i_case);
  check(z_.rows() > 1 && left_out < z_.rows(), "smoother: a case that it has, and others");
  std::vector<Eigen::Index> others;
  for (Eigen::Index i = 0; i < z_.rows(); ++i)
    if (i != left_out) others.push_back(i);
  return of_other_cases(z_(others, Eigen::all), coefficients_of_cases()(others, Eigen::all));
}

SmootherCoefficients::Changed SmootherCoefficients::with_case(std::span<const double> inputs,
                                                              const Eigen::VectorXd& coefficients) const {
  std::vector<double> derived(features_.size());
  features_.evaluate(inputs, derived);
  MatrixD z(z_.rows() + 1, z_.cols());
  z.topRows(z_.rows()) = z_;
  scaler_.apply(derived, {z.row(z_.rows()).data(), derived.size()});
  MatrixD cases(z.rows(), coefficients.size());
  cases << coefficients_of_cases(), coefficients.transpose();
  return of_other_cases(std::move(z), cases);
}

void SmootherCoefficients::predict(std::span<const double> inputs, std::span<double> coefficients,
                                   std::span<double> variance, bool, Workspace& workspace) const {
  const Workspace::Frame frame(workspace);
  const std::span<double> derived = doubles(workspace, features_.size()),
                          z = doubles(workspace, features_.size());
  features_.evaluate(inputs, derived);
  scaler_.apply(derived, z);
  const std::span<double> k = doubles(workspace, static_cast<std::size_t>(z_.rows()));
  const Eigen::Map<const Eigen::VectorXd> k_vector(k.data(), z_.rows());
  std::size_t first = 0;
  for (const Group& group : groups_) {
    for (Eigen::Index i = 0; i < z_.rows(); ++i)
      k[static_cast<std::size_t>(i)] = group.kernel(z.data(), z_.row(i).data());
    const auto n = static_cast<std::size_t>(group.weights.cols());
    for (std::size_t m = 0; m < n; ++m)
      coefficients[first + m] = k_vector.dot(group.weights.col(static_cast<Eigen::Index>(m)));
    if (!variance.empty()) {
      double explained = 0;
      for (Eigen::Index i = 0; i < z_.rows(); ++i) {
        double part = 0;  // row i of a lower triangular matrix
        for (Eigen::Index j = 0; j <= i; ++j)
          part += static_cast<double>(group.inverse_factor(i, j)) * k_vector[j];
        explained += part * part;
      }
      const double left = std::max(0.0, group.kernel(z.data(), z.data()) - explained);
      for (std::size_t m = 0; m < n; ++m)
        variance[first + m] = left * group.signal[static_cast<Eigen::Index>(m)];
    }
    first += n;
  }
}

void SmootherCoefficients::save(io::TensorFile& file, const std::string& prefix) const {
  nlohmann::json kernels = nlohmann::json::array();
  features_.save(file, prefix + "/features");
  save_scaler(file, prefix + "/scaler", scaler_);
  file.set(prefix + "/cases", io::Tensor::copy(z_));
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const std::string group = prefix + "/group" + std::to_string(i);
    kernels.push_back(to_json(groups_[i].kernel));
    kernels.back()["zone"] = groups_[i].zone;
    save_vector(file, group + "/inverse_lengths", groups_[i].kernel.inverse_lengths);
    save_vector(file, group + "/imbalance", groups_[i].kernel.imbalance);
    file.set(group + "/weights", io::Tensor::copy(groups_[i].weights));
    save_vector(file, group + "/signal", groups_[i].signal);
    file.set(group + "/inverse_factor", io::Tensor::copy(groups_[i].inverse_factor));
  }
  file.set_text(prefix, nlohmann::json{{"kind", kind()}, {"kernels", std::move(kernels)}}.dump());
}

std::unique_ptr<CoefficientModel> SmootherCoefficients::load(const io::TensorFile& file,
                                                             const std::string& prefix) {
  const std::string where = file.where() + ":" + prefix;
  const nlohmann::json description = read_description(file, prefix);
  const auto kernels = description.find("kernels");
  if (kernels == description.end() || !kernels->is_array() || kernels->empty() ||
      kernels->size() > most_groups) {
    throw InputError(
        {.what = "incomplete description of a model", .where = where, .expected = "a list \"kernels\""});
  }
  FeatureMap features = FeatureMap::load(file, prefix + "/features");
  math::Standardiser scaler = load_scaler(file, prefix + "/scaler");
  MatrixD cases = load_matrix(file, prefix + "/cases", io::any_size, features.size());
  const auto n_cases = static_cast<std::size_t>(cases.rows());
  std::vector<Group> groups;
  for (std::size_t i = 0; i < kernels->size(); ++i) {
    const std::string name = prefix + "/group" + std::to_string(i);
    Group group{
        kernel_of((*kernels)[i], where), load_matrix(file, name + "/weights", n_cases, io::any_size), {}, {}};
    if (const auto zone = (*kernels)[i].find("zone"); zone != (*kernels)[i].end())  // else of format 1.3
      group.zone = whole_number<std::size_t>(*zone);
    group.kernel.inverse_lengths = load_vector(file, name + "/inverse_lengths", features.size());
    group.kernel.imbalance = load_vector(file, name + "/imbalance", features.size());
    group.signal = load_vector(file, name + "/signal", static_cast<std::size_t>(group.weights.cols()));
    const std::array<std::size_t, 2> square{n_cases, n_cases};
    group.inverse_factor = file.tensor(name + "/inverse_factor", square).matrix();
    groups.push_back(std::move(group));
  }
  return std::make_unique<SmootherCoefficients>(std::move(features), std::move(scaler), std::move(cases),
                                                std::move(groups));
}

}  // namespace elrom::model
