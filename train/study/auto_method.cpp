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

double product_of_rows(const MatrixF& a, const MatrixF& b, Index i) {
  double sum = 0;
  for (Index c = 0; c < a.cols(); ++c) sum += static_cast<double>(a(i, c)) * b(i, c);
  return sum;
}

double sum_of_squares(const MatrixF& a) {
  double sum = 0;
  for (Index i = 0; i < a.rows(); ++i) sum += product_of_rows(a, a, i);
  return sum;
}

/// Which fold each case is in, in the order of `cases`.
std::vector<std::size_t> folds_of(std::span<const std::size_t> cases, const Folds& folds) {
  std::vector<std::size_t> found(cases.size());
  for (std::size_t k = 0; k < folds.size(); ++k) {
    for (const std::size_t row : folds[k])
      found[static_cast<std::size_t>(std::ranges::find(cases, row) - cases.begin())] = k;
  }
  return found;
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
  Contest(const FieldData& data, std::span<const std::size_t> cases, std::span<const Method* const> methods,
          const Folds& folds)
      : data_(data),
        cases_(cases),
        methods_(methods),
        folds_(folds),
        fold_of_(folds_of(cases, folds)),
        variation_(variation(data, cases)) {}

  void run(const FitContext& context) {
    std::exception_ptr first;
    for (const Method* method : methods_) {
      CandidateScore score{.name = method->name(), .nrmse = std::numeric_limits<double>::quiet_NaN()};
      try {
        MatrixF errors = errors_of(method->cross_predict(data_, folds_, context));
        if (!errors.allFinite()) throw NumericalError(score.name + ": predictions are not finite");
        score.nrmse = relative(sum_of_squares(errors));
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
    const std::vector<MatrixXd> grams = grams_of_folds();
    MatrixXd all = grams.front();
    for (std::size_t k = 1; k < grams.size(); ++k) all += grams[k];
    Index best = 0;
    const double single = all.diagonal().minCoeff(&best);
    VectorXd weights = weights_of(all);
    // Weights fitted to the errors that they are judged by flatter a blend; those of the other folds do not.
    double blended = 0;
    for (const MatrixXd& gram : grams) {
      const VectorXd others = weights_of(all - gram);
      blended += others.dot(gram * others);
    }
    const bool blend = std::sqrt(std::max(0.0, blended)) < (1 - least_gain) * std::sqrt(single);
    if (!blend) weights = VectorXd::Unit(weights.size(), best);
    for (Index i = 0; i < weights.size(); ++i) scores_[standing_[size(i)]].weight = weights[i];
    return relative(blend ? blended : single);
  }

  [[nodiscard]] const std::vector<CandidateScore>& scores() const { return scores_; }

 private:
  [[nodiscard]] static std::size_t size(Index i) { return static_cast<std::size_t>(i); }

  [[nodiscard]] static VectorXd weights_of(const MatrixXd& gram) {
    const std::vector<double> weights = blend_weights(gram);
    return VectorXd::Map(weights.data(), gram.rows());
  }

  /// Products of the candidates' errors, summed over the cases of each fold, (n, n).
  [[nodiscard]] std::vector<MatrixXd> grams_of_folds() const {
    const auto n = static_cast<Index>(errors_.size());
    std::vector<MatrixXd> grams(folds_.size(), MatrixXd::Zero(n, n));
    for (std::size_t i_case = 0; i_case < cases_.size(); ++i_case) {
      MatrixXd& gram = grams[fold_of_[i_case]];
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j <= i; ++j)
          gram(i, j) += product_of_rows(errors_[size(i)], errors_[size(j)], static_cast<Index>(i_case));
      }
    }
    for (MatrixXd& gram : grams) gram = MatrixXd(gram.selfadjointView<Eigen::Lower>());
    return grams;
  }

  [[nodiscard]] MatrixF errors_of(const MatrixF& predictions) const {
    MatrixF errors(static_cast<Index>(cases_.size()), data_.values.cols());
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      const auto row = static_cast<Index>(cases_[i]);
      errors.row(static_cast<Index>(i)) = data_.values.row(row) - predictions.row(row);
    }
    return errors;
  }
  [[nodiscard]] double relative(double squares) const {
    return variation_ > 0 ? std::sqrt(std::max(0.0, squares) / variation_) : 0;
  }

  const FieldData& data_;
  std::span<const std::size_t> cases_;
  std::span<const Method* const> methods_;
  const Folds& folds_;
  std::vector<std::size_t> fold_of_;  // of each case
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
  return total > 0 ? std::sqrt(sum_of_squares(residuals) / total) : 0;
}

AutoFit fit_auto(const FieldData& data, std::span<const std::size_t> cases,
                 std::span<const Method* const> candidates, const AutoOptions& options,
                 const FitContext& context) {
  check(!candidates.empty(), "auto: at least one candidate");
  const Folds folds = load_grouped_folds(data.cases->loads, cases, options.n_folds);
  Contest contest(data, cases, candidates, folds);
  contest.run(context);
  AutoFit fit;
  fit.nrmse = contest.decide(options.least_gain);
  fit.candidates = contest.scores();

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
