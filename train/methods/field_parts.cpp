#include "field_parts.hpp"

#include <cmath>
#include <ranges>

#include "elrom/math/pod.hpp"
#include "elrom/math/statistics.hpp"
#include "leave_one_out.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

KernelFeatures features_of(const field::CaseSet& cases, std::span<const std::size_t> rows,
                           const std::vector<SymmetryClass>& classes, std::span<const std::string> wanted) {
  KernelFeatures features{derive_inputs(cases, rows, classes, wanted), {}, {}};
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

std::vector<std::string> names_of(const model::SmootherCoefficients* smoother) {
  std::vector<std::string> names;
  if (smoother == nullptr) return names;
  for (const auto& feature : smoother->features().features()) names.push_back(feature.name);
  return names;
}

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
                       const FitContext& context)
    : classes(symmetry_classes(data.cases->mirrors.size())),
      symmetric(project(data, cases, classes.front(), context.n_threads)),
      mean(math::row_mean(symmetric, math::all_rows(cases.size()), context.n_threads)) {
  for (Index i = 0; i < symmetric.rows(); ++i) symmetric.row(i) -= mean.transpose().cast<float>();
  const auto* smoother = context.warm == nullptr ? nullptr : context.warm->smoother();
  features = features_of(*data.cases, cases, classes, names_of(smoother));
  if (smoother != nullptr && features.same_as(smoother->features())) earlier = smoother;
  if (nothing_to_learn() || earlier_kernel(0, 0) != nullptr) return;
  earlier = nullptr;
  choose(*data.cases, cases, zones_of(*data.cases, 1).front().gram(symmetric, symmetric));
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
