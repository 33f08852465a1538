#include "field_parts.hpp"

#include <fmt/format.h>

#include <cmath>
#include <ranges>

#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/pod.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/composite_models.hpp"
#include "field_scale.hpp"
#include "leave_one_out.hpp"
#include "smoother_modes.hpp"
#include "zones.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Features of the cases, (rows.size(), map.size()).
MatrixD evaluated(const model::FeatureMap& map, const field::CaseSet& cases,
                  std::span<const std::size_t> rows) {
  MatrixD values(static_cast<Index>(rows.size()), static_cast<Index>(map.size()));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = cases.inputs.row(static_cast<Index>(rows[i]));
    auto out = values.row(static_cast<Index>(i));
    map.evaluate({row.data(), static_cast<std::size_t>(row.size())},
                 {out.data(), static_cast<std::size_t>(out.size())});
  }
  return values;
}

KernelFeatures features_of(const field::CaseSet& cases, std::span<const std::size_t> rows,
                           const std::vector<SymmetryClass>& classes, std::span<const std::string> wanted) {
  KernelFeatures features{derive_inputs(cases, rows, classes, wanted), {}, {}};
  const MatrixD raw = evaluated(features.derived.map, cases, rows);
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

std::vector<std::string> names_of(const model::SmootherCoefficients* smoother) {
  std::vector<std::string> names;
  if (smoother == nullptr) return names;
  for (const auto& feature : smoother->features().features()) names.push_back(feature.name);
  return names;
}

/// Exponents of the scale and the kernel's lengths are found in turns; each moves the other's optimum.
constexpr int n_scale_passes = 3;

struct Trial {
  KernelFeatures features;
  model::SmootherKernel kernel;
  double error = 0;  // leave-one-out
};
Trial trial(KernelFeatures of, const MatrixXd& gram, math::Covariance covariance) {
  const MatrixD& z = of.z;
  auto kernel = fit_symmetric_kernel(z, of.of_class(0), gram, covariance);
  const double error = leave_one_out_error(kernel.matrix(z, z), kernel.noise, gram);
  return {std::move(of), std::move(kernel), error};
}

}  // namespace

FieldParts::FieldParts(const field::FieldData& data, std::span<const std::size_t> cases,
                       const FitContext& context, bool scaled)
    : classes(symmetry_classes(data.cases->mirrors.size())),
      domain(*data.cases, data.info.parity, classes),
      symmetric(domain.project(data.values, cases, 0, context.n_threads)),
      mean(math::row_mean(symmetric, math::all_rows(cases.size()), context.n_threads)),
      scales(VectorXd::Ones(symmetric.rows())) {
  for (Index i = 0; i < symmetric.rows(); ++i) symmetric.row(i) -= mean.transpose().cast<float>();
  const auto* smoother = context.warm == nullptr ? nullptr : context.warm->smoother();
  features = features_of(*data.cases, cases, classes, names_of(smoother));
  if (smoother != nullptr && features.same_as(smoother->features())) earlier = smoother;
  if (nothing_to_learn()) return;
  const MatrixXd gram = zones_of(domain, 1).front().gram(symmetric, symmetric);
  if (earlier_kernel(0, 0) == nullptr) {
    earlier = nullptr;
    choose(*data.cases, cases, gram);
  }
  if (scaled) learn_scale(*data.cases, cases, gram, context.n_threads);
}

MatrixF FieldParts::part(const field::FieldData& data, std::span<const std::size_t> cases, std::size_t c,
                         int n_threads) const {
  MatrixF part = domain.project(data.values, cases, c, n_threads);
  if (scale) part = scales.cwiseInverse().cast<float>().asDiagonal() * part;
  return part;
}

VectorXd FieldParts::whole_mean() const {
  MatrixF whole = MatrixF::Zero(1, static_cast<Index>(domain.n_all_cells()));
  domain.add(0, mean.transpose().cast<float>(), whole, 1);
  return whole.row(0).transpose().cast<double>();
}

std::unique_ptr<model::FieldModel> FieldParts::with_scale(std::unique_ptr<model::FieldModel> model) const {
  if (!scale) return model;
  return std::make_unique<model::ScaledModel>(model::FeatureMap({*scale}, model->n_inputs()),
                                              std::move(model));
}

const model::SmootherKernel* FieldParts::earlier_kernel(std::size_t c, std::size_t zone) const {
  if (earlier == nullptr) return nullptr;
  const auto own = features.of_class(c);
  // The last symmetric group of a zone has the zone's own kernel.
  for (const auto& group : std::views::reverse(earlier->groups())) {
    if (group.kernel.antisymmetric != (c > 0) || group.zone != zone) continue;
    const VectorXd& used = c > 0 ? group.kernel.imbalance : group.kernel.inverse_lengths;
    if ((used.array() > 0).count() == static_cast<Index>(own.size()) && (used(own).array() > 0).all())
      return &group.kernel;
  }
  return nullptr;
}

const model::SmootherKernel& FieldParts::start(std::size_t zone) const {
  const auto* own = earlier_kernel(0, zone);
  return own != nullptr ? *own : first ? *first : *earlier_kernel(0, 0);
}

void FieldParts::learn_scale(const field::CaseSet& cases, std::span<const std::size_t> rows,
                             const MatrixXd& gram, int n_threads) {
  const auto& quantities = features.derived.scales;
  if (quantities.empty()) return;
  const Index n = symmetric.rows(), n_quantities = std::ssize(quantities);
  const MatrixD logs =
      evaluated(model::FeatureMap(quantities, static_cast<std::size_t>(cases.inputs.cols())), cases, rows);
  VectorXd by_mean(n);
  for (Index i = 0; i < n; ++i) by_mean[i] = symmetric.row(i).cast<double>().dot(mean);
  MatrixXd whole = gram.array() + mean.squaredNorm();  // products of the cases, not of departures
  whole.colwise() += by_mean;
  whole.rowwise() += by_mean.transpose();

  const MatrixD& z = features.z;
  const auto residual_of = [&](const model::SmootherKernel& kernel) {
    return residual_operation(Smoother(kernel, z).leave_one_out_about_mean());
  };
  model::SmootherKernel kernel = start(0);
  if (earlier != nullptr)  // its kernel is of a field over the scale that was right then
    kernel = fit_symmetric_kernel(z, features.of_class(0), gram, kernel.covariance, &kernel);
  const VectorXd unscaled = scaled_errors(residual_of(kernel), whole, scales);
  VectorXd exponents = VectorXd::Zero(n_quantities), found = scales;
  for (int pass = 0; pass < n_scale_passes; ++pass) {
    exponents = fit_exponents(residual_of(kernel), whole, logs, exponents);
    found = (logs * exponents).array().exp();
    const VectorXd inverse = found.cwiseInverse();
    kernel = fit_symmetric_kernel(z, features.of_class(0),
                                  math::centred_products(inverse.asDiagonal() * whole * inverse.asDiagonal()),
                                  kernel.covariance, &kernel);
  }
  if (significance(unscaled - scaled_errors(residual_of(kernel), whole, found)) < 1) return;

  model::Feature power;
  for (Index j = 0; j < n_quantities; ++j) {
    const model::Feature& quantity = quantities[static_cast<std::size_t>(j)];
    if (const auto shown = fmt::format("{:.2f}", exponents[j]); shown != "0.00" && shown != "-0.00")
      power.name += (power.name.empty() ? "" : " ") + quantity.name + "^" + shown;
    power.terms.push_back(quantity.terms.front());
    power.terms.back().coefficient = exponents[j];
  }
  if (power.name.empty()) return;  // next to no scale

  scale = std::move(power);
  scales = std::move(found);
  first = std::move(kernel);
  for (Index i = 0; i < n; ++i)
    symmetric.row(i) = (symmetric.row(i) + mean.transpose().cast<float>()) / static_cast<float>(scales[i]);
  mean = math::row_mean(symmetric, math::all_rows(rows.size()), n_threads);
  for (Index i = 0; i < n; ++i) symmetric.row(i) -= mean.transpose().cast<float>();
}

void FieldParts::choose(const field::CaseSet& cases, std::span<const std::size_t> rows,
                        const MatrixXd& gram) {
  using enum math::Covariance;
  Trial best = trial(features, gram, matern52);
  const auto take_better = [&](Trial other) {
    if (other.error < best.error) best = std::move(other);
  };
  const auto other_covariance = [&] { return best.kernel.covariance == gaussian ? matern52 : gaussian; };
  take_better(trial(best.features, gram, other_covariance()));
  std::vector<std::string> chosen;
  for (const auto& forms : features.derived.forms) {
    for (const auto& form : forms) {
      auto wanted = chosen;
      wanted.push_back(form);
      auto other = features_of(cases, rows, classes, wanted);
      const bool new_form = !best.features.has(form);
      if (new_form && other.of_class(0).size() == best.features.of_class(0).size())
        take_better(trial(std::move(other), gram, best.kernel.covariance));
    }
    for (const auto& form : forms)
      if (best.features.has(form)) chosen.push_back(form);
  }
  if (!chosen.empty()) take_better(trial(best.features, gram, other_covariance()));
  features = std::move(best.features);
  first = std::move(best.kernel);
}

}  // namespace elrom::methods
