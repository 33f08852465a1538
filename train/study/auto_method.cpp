#include "elrom/study/auto_method.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/study/cross_validation.hpp"

namespace elrom::study {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double sum_of_products(const MatrixF& a, const MatrixF& b) {
  double sum = 0;
  for (Index i = 0; i < a.rows(); ++i) {
    double row = 0;
    for (Index c = 0; c < a.cols(); ++c) row += static_cast<double>(a(i, c)) * b(i, c);
    sum += row;
  }
  return sum;
}

/// Sum of squared deviations from the rows' own mean.
double variation(const FieldData& data, std::span<const std::size_t> cases) {
  return math::column_moments(data.values, cases).deviation.squaredNorm() * static_cast<double>(cases.size());
}

/// Weights that minimise w^T G w for sum w = 1 over the chosen members, without the sign condition.
VectorXd unconstrained(const MatrixXd& gram, const std::vector<Index>& members) {
  const auto n = static_cast<Index>(members.size());
  MatrixXd part(n, n);
  for (Index i = 0; i < n; ++i) {
    for (Index j = 0; j < n; ++j)
      part(i, j) = gram(members[static_cast<std::size_t>(i)], members[static_cast<std::size_t>(j)]);
  }
  part.diagonal().array() += 1e-12 * part.trace() + 1e-300;  // equal candidates share their weight
  const VectorXd solution = part.ldlt().solve(VectorXd::Ones(n));
  return solution / solution.sum();
}

/// Cross-validated errors of every candidate that ends in finite numbers.
class Contest {
 public:
  Contest(const FieldData& data, std::span<const std::size_t> cases, std::span<const Method* const> methods)
      : data_(data), cases_(cases), methods_(methods), variation_(variation(data, cases)) {}

  void run(const Folds& folds, const FitContext& context) {
    std::exception_ptr first;
    for (const Method* method : methods_) {
      CandidateScore score{.name = method->name(), .nrmse = std::numeric_limits<double>::quiet_NaN()};
      try {
        MatrixF errors = errors_of(method->cross_predict(data_, folds, context));
        if (!errors.allFinite()) throw NumericalError(score.name + ": predictions are not finite");
        score.nrmse = relative(sum_of_products(errors, errors));
        standing_.push_back(scores_.size());
        errors_.push_back(std::move(errors));
      } catch (const NumericalError& error) {
        if (!first) first = std::current_exception();
        score.failure = error.what();
        context.log->warning("auto: " + score.name + " is out for " + data_.info.name + ": " + error.what());
      }
      scores_.push_back(std::move(score));
    }
    if (errors_.empty()) std::rethrow_exception(first);
  }

  /// Sets the weights of the final model. @return its cross-validated error
  double decide(double least_gain) {
    const auto n = static_cast<Index>(errors_.size());
    MatrixXd gram(n, n);
    for (Index i = 0; i < n; ++i) {
      for (Index j = 0; j <= i; ++j)
        gram(i, j) = gram(j, i) = sum_of_products(errors_[size(i)], errors_[size(j)]);
    }
    Index best = 0;
    gram.diagonal().minCoeff(&best);
    const std::vector<double> weights = blend_weights(gram);
    const VectorXd w = VectorXd::Map(weights.data(), n);
    const double blended = std::sqrt(std::max(0.0, w.dot(gram * w))), single = std::sqrt(gram(best, best));
    const bool blend = blended < (1 - least_gain) * single;
    for (Index i = 0; i < n; ++i) scores_[standing_[size(i)]].weight = blend ? w[i] : (i == best ? 1 : 0);
    return relative(std::pow(blend ? blended : single, 2));
  }

  [[nodiscard]] MatrixF residuals() const {
    MatrixF sum = MatrixF::Zero(errors_.front().rows(), errors_.front().cols());
    for (std::size_t i = 0; i < errors_.size(); ++i) {
      if (const double weight = scores_[standing_[i]].weight; weight > 0)
        sum += static_cast<float>(weight) * errors_[i];
    }
    return sum;
  }

  [[nodiscard]] const std::vector<CandidateScore>& scores() const { return scores_; }

 private:
  [[nodiscard]] static std::size_t size(Index i) { return static_cast<std::size_t>(i); }

  [[nodiscard]] MatrixF errors_of(const MatrixF& predictions) const {
    MatrixF errors(static_cast<Index>(cases_.size()), data_.values.cols());
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      const auto row = static_cast<Index>(cases_[i]);
      errors.row(static_cast<Index>(i)) = data_.values.row(row) - predictions.row(row);
    }
    return errors;
  }
  [[nodiscard]] double relative(double squares) const {
    return variation_ > 0 ? std::sqrt(squares / variation_) : 0;
  }

  const FieldData& data_;
  std::span<const std::size_t> cases_;
  std::span<const Method* const> methods_;
  double variation_;
  std::vector<CandidateScore> scores_;
  std::vector<std::size_t> standing_;  // place in scores_ of each entry of errors_
  std::vector<MatrixF> errors_;        // (n_cases, n_cells)
};

std::unique_ptr<model::FieldModel> blend(const std::vector<double>& weights,
                                         std::vector<std::unique_ptr<model::FieldModel>> models) {
  std::vector<model::BlendModel::Part> parts;
  for (std::size_t i = 0; i < weights.size(); ++i) parts.push_back({weights[i], std::move(models[i])});
  return std::make_unique<model::BlendModel>(std::move(parts));
}

}  // namespace

std::vector<double> blend_weights(const MatrixXd& error_gram) {
  std::vector<Index> members(static_cast<std::size_t>(error_gram.rows()));
  for (std::size_t i = 0; i < members.size(); ++i) members[i] = static_cast<Index>(i);
  // Drop the most negative weight until none is left: for a handful of candidates this is the optimum or next
  // to it.
  VectorXd weights = unconstrained(error_gram, members);
  constexpr double negligible = 0.1;  // a member with less costs more to evaluate than it gives
  for (Index least = 0; members.size() > 1 && weights.minCoeff(&least) < negligible;) {
    members.erase(members.begin() + least);
    weights = unconstrained(error_gram, members);
  }
  std::vector<double> all(static_cast<std::size_t>(error_gram.rows()), 0.0);
  for (std::size_t i = 0; i < members.size(); ++i)
    all[static_cast<std::size_t>(members[i])] = weights[static_cast<Index>(i)];
  return all;
}

double cross_validated_nrmse(const FieldData& data, std::span<const std::size_t> cases,
                             const MatrixF& residuals) {
  const double total = variation(data, cases);
  return total > 0 ? std::sqrt(sum_of_products(residuals, residuals) / total) : 0;
}

AutoFit fit_auto(const FieldData& data, std::span<const std::size_t> cases,
                 std::span<const Method* const> candidates, const AutoOptions& options,
                 const FitContext& context) {
  check(!candidates.empty(), "auto: at least one candidate");
  Contest contest(data, cases, candidates);
  contest.run(load_grouped_folds(data.cases->loads, cases, options.n_folds), context);
  AutoFit fit;
  fit.nrmse = contest.decide(options.least_gain);
  fit.candidates = contest.scores();
  fit.residuals = contest.residuals();

  std::vector<double> weights;
  std::vector<std::unique_ptr<model::FieldModel>> models;
  std::string told;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const CandidateScore& score = fit.candidates[i];
    told += " " + score.name + " " + base::rounded(score.nrmse, 3) + (score.weight > 0 ? "*" : "");
    if (!(score.weight > 0)) continue;
    weights.push_back(score.weight);
    models.push_back(candidates[i]->fit(data, cases, context));
  }
  context.log->detail("auto: " + data.info.name + ":" + told);
  fit.model = models.size() == 1 ? std::move(models.front()) : blend(weights, std::move(models));
  return fit;
}

}  // namespace elrom::study
