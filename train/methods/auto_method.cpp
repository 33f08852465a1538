#include "elrom/methods/auto_method.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/math/statistics.hpp"
#include "elrom/methods/cross_validation.hpp"
#include "elrom/model/composite_models.hpp"
#include "elrom/networks/banding.hpp"
#include "race.hpp"

namespace elrom::methods {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Which fold each case is in, in the order of `cases`.
std::vector<std::size_t> fold_of_each(std::span<const std::size_t> cases, const Folds& folds) {
  std::vector<std::size_t> found(cases.size());
  for (std::size_t k = 0; k < folds.size(); ++k) {
    for (const std::size_t row : folds[k])
      found[static_cast<std::size_t>(std::ranges::find(cases, row) - cases.begin())] = k;
  }
  return found;
}

/// Squared deviations from the rows' own mean, summed over rows and planes, (n_columns).
VectorXd variation_of_columns(const field::FieldData& data, std::span<const std::size_t> cases) {
  const auto moments = math::column_moments(data.values, cases);
  const auto n_columns = static_cast<Index>(data.cases->mesh.n_columns);
  VectorXd sums = VectorXd::Zero(n_columns);
  for (Index first = 0; first < moments.deviation.size(); first += n_columns)
    sums.array() += moments.deviation.segment(first, n_columns).array().square();
  return sums * static_cast<double>(cases.size());
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
  const VectorXd solution = math::Cholesky(part).solve(VectorXd::Ones(n));
  return solution / solution.sum();
}

/// Without the members that have next to no weight.
VectorXd without_negligible(const VectorXd& weights) {
  const VectorXd kept = (weights.array() < negligible_weight).select(0, weights);
  return kept / kept.sum();
}

/// (1 - share) a + share b, (n, n_columns). @param a, b (n, n_columns), or (n, 1): the same in all columns
MatrixXd mixed(const MatrixXd& a, const MatrixXd& b, double share) {
  MatrixXd weights(a.rows(), std::max(a.cols(), b.cols()));
  for (Index c = 0; c < weights.cols(); ++c)
    weights.col(c) = without_negligible((1 - share) * a.col(c % a.cols()) + share * b.col(c % b.cols()));
  return weights;
}

/// Cross-validated errors of every candidate that ends in finite numbers, and what follows from them.
class Contest {
 public:
  Contest(const field::FieldData& data, std::span<const std::size_t> cases,
          std::span<const Method* const> methods, const Folds& folds, const AutoOptions& options)
      : data_(data),
        cases_(cases),
        methods_(methods),
        folds_(folds),
        options_(options),
        fold_of_(fold_of_each(cases, folds)),
        variation_(variation_of_columns(data, cases)) {}

  void run(FitContext context) {
    std::exception_ptr first;
    FoldPredictions known;
    for (const Method* method : methods_) {
      CandidateScore score{.name = method->name(), .nrmse = std::numeric_limits<double>::quiet_NaN()};
      try {
        Tried tried = race(*method, context);
        score.nrmse = nrmse_of(tried);
        if (tried.n_folds < folds_.size()) {
          score.left_after = tried.n_folds;
        } else {
          if (standing_.empty()) {
            known = {method->key(data_.info.name), std::move(tried.predictions)};
            context.known = &known;
          }
          standing_.push_back(scores_.size());
          errors_.push_back(std::move(tried.errors));
          sum_products();
          blend_ = blend_so_far();
        }
      } catch (const NumericalError& error) {
        if (!first) first = std::current_exception();
        score.failure = error.what();
        context.log->warning("auto: " + score.name + " is out for " + data_.info.name + ": " + error.what());
      }
      scores_.push_back(std::move(score));
    }
    if (errors_.empty()) std::rethrow_exception(first);
    errors_.clear();
  }

  /// Weights of the final model, and its cross-validated error: the best candidate, moved towards a blend and
  /// then towards a blend for each band of columns as far as those gain.
  [[nodiscard]] AutoFit decide() const {
    const MatrixD total = products_of_all_folds();
    const MatrixXd gram = gram_of(total);

    // What is chosen or fitted by the errors that it is judged by is flattered: the other folds choose.
    Answer answer{alone(gram)}, blend{weights_of(gram)}, by_band{band_weights(total, 0)};
    for (std::size_t k = 0; k < products_.size(); ++k) {
      const MatrixD others = total - products_[k];
      answer.of_folds.emplace_back(alone(gram_of(others)));
      blend.of_folds.emplace_back(weights_of(gram_of(others)));
      by_band.of_folds.push_back(band_weights(others, folds_[k].size()));
    }
    answer = judged(std::move(answer));
    const bool has_bands = by_band.weights.cols() > 1;
    answer = moved(answer, judged(std::move(blend)));
    by_band = judged(std::move(by_band));
    if (has_bands) answer = moved(answer, by_band);
    AutoFit fit{.candidates = scores_,
                .nrmse = relative(answer.squares),
                .nrmse_by_band = has_bands ? relative(by_band.squares) : NAN};
    for (Index i = 0; i < answer.weights.rows(); ++i) {
      CandidateScore& score = fit.candidates[standing_[static_cast<std::size_t>(i)]];
      if (answer.weights.row(i).maxCoeff() > 0)
        score.weights.assign(answer.weights.row(i).begin(), answer.weights.row(i).end());
    }
    return fit;
  }

 private:
  /// What a candidate has shown so far.
  struct Tried {
    MatrixF errors;                 // (n_cases, n_cells), 0 where it was not tried
    std::vector<std::size_t> rows;  // of errors that it was tried in
    std::size_t n_folds = 0;
    MatrixF predictions;  // of the folds that it was tried in last
  };
  [[nodiscard]] Tried race(const Method& method, const FitContext& context) const {
    Tried tried{MatrixF::Zero(static_cast<Index>(cases_.size()), data_.values.cols()), {}, 0, {}};
    if (errors_.empty()) {
      try_in(method, math::all_rows(folds_.size()), tried, context);
      return tried;
    }
    for (const auto& round : rounds_of(folds_.size())) {
      try_in(method, round, tried, context);
      if (!may_gain(shown(tried), options_.full_gain)) break;
    }
    return tried;
  }
  void try_in(const Method& method, std::span<const std::size_t> wanted, Tried& tried,
              const FitContext& context) const {
    tried.predictions = method.predict_folds(data_, folds_, wanted, context);
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      if (std::ranges::find(wanted, fold_of_[i]) == wanted.end()) continue;
      const auto row = static_cast<Index>(cases_[i]);
      tried.errors.row(static_cast<Index>(i)) = data_.values.row(row) - tried.predictions.row(row);
      tried.rows.push_back(i);
    }
    if (!tried.errors.allFinite()) throw NumericalError(method.name() + ": predictions are not finite");
    tried.n_folds += wanted.size();
  }
  [[nodiscard]] double nrmse_of(const Tried& tried) const {
    if (tried.n_folds == folds_.size()) return relative(math::sum_of_squares(tried.errors));
    const MatrixF& best = *std::ranges::min_element(errors_, {}, math::sum_of_squares);
    const auto squares = [&](const MatrixF& of) { return math::sum_of_squares(of(tried.rows, Eigen::all)); };
    return relative(math::sum_of_squares(best)) * std::sqrt(squares(tried.errors) / squares(best));
  }

  /// A candidate beside the blend, in the cases that it was tried in.
  [[nodiscard]] Shown shown(const Tried& tried) const {
    const auto bands = bands_of(squares_in_columns(blend_));
    const auto n = static_cast<Index>(tried.rows.size()), n_bands = std::ssize(bands);
    Shown shown{MatrixXd(n, n_bands), VectorXd::Zero(n_bands), 0};
    for (Index i = 0; i < n; ++i) {
      const auto row = static_cast<Index>(tried.rows[static_cast<std::size_t>(i)]);
      const Eigen::RowVectorXf b = blend_.row(row), d = tried.errors.row(row) - b;
      const VectorXd gains = -by_column(b.cwiseProduct(d)), departures = by_column(d.cwiseAbs2());
      for (Index k = 0; k < n_bands; ++k) {
        const auto& columns = bands[static_cast<std::size_t>(k)];
        shown.gains(i, k) = gains(columns).sum();
        shown.departures[k] += departures(columns).sum();
      }
      shown.squares += static_cast<double>(b.squaredNorm());
    }
    return shown;
  }

  /// Errors of the best blend of the candidates that stand, (n_cases, n_cells).
  [[nodiscard]] MatrixF blend_so_far() const {
    const VectorXd weights = weights_of(gram_of(products_of_all_folds()));
    MatrixF blend = MatrixF::Zero(errors_.front().rows(), errors_.front().cols());
    for (Index i = 0; i < weights.size(); ++i)
      if (weights[i] > 0) blend += static_cast<float>(weights[i]) * errors_[static_cast<std::size_t>(i)];
    return blend;
  }

  /// Weights from all folds, those from all folds but one, and the squared error of the latter in the folds
  /// that they have not seen.
  struct Answer {
    MatrixXd weights;
    std::vector<MatrixXd> of_folds = {};
    double squares = 0;
  };
  [[nodiscard]] Answer judged(Answer answer) const {
    answer.squares = 0;
    for (std::size_t k = 0; k < products_.size(); ++k)
      answer.squares += squares_of(products_[k], answer.of_folds[k]);
    return answer;
  }
  /// From one answer towards another: all the way where that lowers the error by full_gain. No jump at any
  /// gain, so that a last bit, which changes every gain a little, changes the answer a little.
  [[nodiscard]] Answer moved(const Answer& from, const Answer& to) const {
    const double share =
        std::clamp((1 - relative(to.squares) / relative(from.squares)) / options_.full_gain, 0.0, 1.0);
    if (!(share > 0)) return from;
    Answer answer{mixed(from.weights, to.weights, share)};
    for (std::size_t k = 0; k < products_.size(); ++k)
      answer.of_folds.push_back(mixed(from.of_folds[k], to.of_folds[k], share));
    return judged(std::move(answer));
  }

  /// All weight to the best candidate.
  [[nodiscard]] static VectorXd alone(const MatrixXd& gram) {
    Index best = 0;
    gram.diagonal().minCoeff(&best);
    return VectorXd::Unit(gram.rows(), best);
  }
  [[nodiscard]] static VectorXd weights_of(const MatrixXd& gram) {
    const std::vector<double> weights = blend_weights(gram);
    return without_negligible(VectorXd::Map(weights.data(), gram.rows()));
  }

  /// Products of the candidates' errors, summed over the planes and over the cases of each fold:
  /// (n * n, n_columns), so that the Gram matrix of any set of columns is a sum.
  void sum_products() {
    const auto n = static_cast<Index>(errors_.size()), n_columns = variation_.size();
    products_.assign(folds_.size(), MatrixD::Zero(n * n, n_columns));
    for (std::size_t i_case = 0; i_case < cases_.size(); ++i_case) {
      MatrixD& products = products_[fold_of_[i_case]];
      for (Index i = 0; i < n; ++i) {
        for (Index j = 0; j <= i; ++j) {
          const auto a = errors_[static_cast<std::size_t>(i)].row(static_cast<Index>(i_case)).cast<double>();
          const auto b = errors_[static_cast<std::size_t>(j)].row(static_cast<Index>(i_case)).cast<double>();
          for (Index first = 0; first < a.size(); first += n_columns)
            products.row(i * n + j) += a.segment(first, n_columns).cwiseProduct(b.segment(first, n_columns));
        }
      }
    }
    for (MatrixD& products : products_) {
      for (Index i = 0; i < n; ++i)
        for (Index j = 0; j < i; ++j) products.row(j * n + i) = products.row(i * n + j);
    }
  }

  [[nodiscard]] MatrixD products_of_all_folds() const {
    MatrixD total = products_.front();
    for (std::size_t k = 1; k < products_.size(); ++k) total += products_[k];
    return total;
  }
  [[nodiscard]] MatrixXd gram_of(const MatrixD& products) const {
    return VectorXd(products.rowwise().sum()).reshaped(n_standing(), n_standing());
  }

  /// Squared error of the candidates weighed by the same weights everywhere, (n, 1), or by column.
  [[nodiscard]] double squares_of(const MatrixD& products, const MatrixXd& weights) const {
    if (weights.cols() == 1) return weights.col(0).dot(gram_of(products) * weights.col(0));
    double sum = 0;
    for (Index c = 0; c < products.cols(); ++c)
      sum += weights.col(c).dot(gram_of(products.col(c)) * weights.col(c));
    return sum;
  }

  /// Weights for each band of columns by the errors in `products`, which leave out so many cases: (n,
  /// n_columns), or (n, 1) when all columns are in one band.
  [[nodiscard]] MatrixXd band_weights(const MatrixD& products, std::size_t cases_left_out) const {
    const MatrixXd gram = gram_of(products);
    const double share = 1 - static_cast<double>(cases_left_out) / static_cast<double>(cases_.size());
    Index best = 0;
    gram.diagonal().minCoeff(&best);
    const auto bands = bands_of(products.row(best * (gram.rows() + 1)) / share);
    const VectorXd everywhere = weights_of(gram);
    if (bands.size() == 1) return everywhere;

    MatrixXd weights(gram.rows(), products.cols());
    for (const auto& columns : bands) {
      const MatrixXd own = gram_of(products(Eigen::all, columns));
      // Where all are exact, as in columns that never change, any weights do: no further members for them.
      weights(Eigen::all, columns).colwise() = own.trace() > 0 ? weights_of(own) : everywhere;
    }
    return weights;
  }

  /// Columns of each band that has any. @param squares of the errors of all cases in each column
  [[nodiscard]] std::vector<std::vector<Index>> bands_of(const VectorXd& squares) const {
    std::vector<std::vector<Index>> bands(options_.band_edges.size() + 1);
    for (Index c = 0; c < squares.size(); ++c)
      bands[networks::band_of(squares[c] / variation_[c], options_.band_edges)].push_back(c);
    std::erase_if(bands, [](const auto& columns) { return columns.empty(); });
    return bands;
  }
  /// Sums over the planes, (n_columns). @param cells (n_cells)
  [[nodiscard]] VectorXd by_column(const Eigen::RowVectorXf& cells) const {
    const Index n_columns = variation_.size();
    return cells.reshaped(n_columns, cells.size() / n_columns).cast<double>().rowwise().sum();
  }
  [[nodiscard]] VectorXd squares_in_columns(const MatrixF& errors) const {
    VectorXd sums = VectorXd::Zero(variation_.size());
    for (Index row = 0; row < errors.rows(); ++row) sums += by_column(errors.row(row).cwiseAbs2());
    return sums;
  }
  [[nodiscard]] double relative(double squares) const {
    return math::nrmse(std::max(0.0, squares), variation_.sum(), 0);
  }
  [[nodiscard]] Index n_standing() const { return static_cast<Index>(standing_.size()); }

  const field::FieldData& data_;
  std::span<const std::size_t> cases_;
  std::span<const Method* const> methods_;
  const Folds& folds_;
  const AutoOptions& options_;
  std::vector<std::size_t> fold_of_;  // of each case
  VectorXd variation_;                // of each column
  std::vector<CandidateScore> scores_;
  std::vector<std::size_t> standing_;  // places in scores_ of the n that were tried in all folds
  std::vector<MatrixF> errors_;        // of those n, until all have been tried
  MatrixF blend_;                      // errors of their best blend
  std::vector<MatrixD> products_;      // of each fold
};

}  // namespace

double CandidateScore::mean_weight() const {
  // One after the other: the order of a vectorised sum depends on where the heap put the weights.
  const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
  return weights.empty() ? 0 : sum / static_cast<double>(weights.size());
}

std::vector<double> blend_weights(const MatrixXd& error_gram) {
  const Index n = error_gram.rows();
  check(n > 0 && static_cast<double>(n) * negligible_weight < 1,
        "blend_weights: few enough that one has weight");
  std::vector<double> best;
  double least = std::numeric_limits<double>::infinity();
  for (unsigned set = 1; set < 1U << n; ++set) {
    std::vector<Index> members;
    for (Index i = 0; i < n; ++i)
      if ((set >> i & 1U) != 0) members.push_back(i);
    const VectorXd weights = unconstrained(error_gram, members);
    if (weights.minCoeff() < 0) continue;
    const double squares = weights.dot(error_gram(members, members) * weights);
    if (!(squares < least)) continue;
    least = squares;
    best.assign(static_cast<std::size_t>(n), 0.0);
    for (std::size_t i = 0; i < members.size(); ++i)
      best[static_cast<std::size_t>(members[i])] = weights[static_cast<Index>(i)];
  }
  check(!best.empty(), "blend_weights: finite errors");
  return best;
}

double cross_validated_nrmse(const field::FieldData& data, std::span<const std::size_t> cases,
                             const MatrixF& residuals) {
  return math::nrmse(math::sum_of_squares(residuals), variation_of_columns(data, cases).sum(), 0);
}

AutoFit fit_auto(const field::FieldData& data, std::span<const std::size_t> cases,
                 std::span<const Method* const> candidates, const AutoOptions& options,
                 const FitContext& context) {
  check(!candidates.empty(), "auto: at least one candidate");
  const auto& loads = data.cases->loads;
  const Folds folds = folds_of(cases, loads, context, [&](std::span<const std::size_t> rows) {
    return load_grouped_folds(loads, rows, options.n_folds);
  });
  Contest contest(data, cases, candidates, folds, options);
  contest.run(context);
  AutoFit fit = contest.decide();

  std::vector<model::BlendModel::Member> parts;
  std::string told;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const CandidateScore& score = fit.candidates[i];
    told += " " + score.name + " " + base::rounded(score.nrmse, 3) + (score.weights.empty() ? "" : "*");
    if (score.left_after > 0)
      told += fmt::format(" (left after {} of {} folds)", score.left_after, folds.size());
    if (!score.weights.empty()) parts.push_back({score.weights, candidates[i]->fit(data, cases, context)});
  }
  if (std::isfinite(fit.nrmse_by_band))
    told += ", band by band " + base::rounded(fit.nrmse_by_band, 3) +
            (parts.front().weights.size() > 1 ? "*" : "");
  context.log->detail("auto: " + data.info.name + ":" + told);
  if (parts.size() == 1)
    fit.model = std::move(parts.front().model);
  else
    fit.model = std::make_unique<model::BlendModel>(std::move(parts));
  return fit;
}

}  // namespace elrom::methods
