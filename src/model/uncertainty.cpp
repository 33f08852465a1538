#include "elrom/model/uncertainty.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/math/ridge.hpp"
#include "elrom/math/standardiser.hpp"
#include "elrom/math/statistics.hpp"
#include "model_parts.hpp"

namespace elrom::model {

namespace {

constexpr std::size_t most_scores = 400'000;  // enough for the 99.9 % quantile to three digits

/// Levels of the table; between them quantiles are interpolated.
const std::vector<double>& table_levels() {
  static const std::vector<double> levels = [] {
    std::vector<double> all;
    for (int i = 0; i <= 45; ++i) all.push_back(0.01 * (2 * i));
    for (int i = 91; i <= 99; ++i) all.push_back(0.01 * i);
    all.insert(all.end(), {0.995, 0.999, 1.0});
    return all;
  }();
  return levels;
}

/// Root mean square of each column's residuals, each case's divided by its size.
Eigen::VectorXd root_mean_squares(const MatrixF& residuals, const Eigen::VectorXd& sizes) {
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(residuals.cols());
  for (Eigen::Index i = 0; i < residuals.rows(); ++i)
    squares += residuals.row(i).transpose().cast<double>().cwiseAbs2() / (sizes[i] * sizes[i]);
  return (squares / static_cast<double>(residuals.rows())).cwiseSqrt();
}

/// Root mean square of each case's residuals in units of the cells' scale; 1 where that says nothing.
Eigen::VectorXd sizes_of(const MatrixF& residuals, const Eigen::VectorXd& scale) {
  constexpr double smallest = 1e-3;  // an error of zero has no logarithm
  Eigen::VectorXd sizes(residuals.rows());
  for (Eigen::Index i = 0; i < residuals.rows(); ++i) {
    double sum = 0, n = 0;
    for (Eigen::Index c = 0; c < residuals.cols(); ++c) {
      if (!(scale[c] > 0)) continue;
      sum += std::pow(residuals(i, c) / scale[c], 2);
      ++n;
    }
    sizes[i] = n > 0 ? std::max(std::sqrt(sum / n), smallest) : 1;
  }
  return sizes;
}

/// What scores are divided by: expected sizes of the cases by all of them, and by the others.
struct Sizes {
  Eigen::VectorXd fitted, left_out;
};

/// |residual| over what the other cases let expect, so that no score is measured by itself; over evenly
/// spread cells.
std::vector<double> pooled_scores(const MatrixF& residuals, const Eigen::VectorXd& scale,
                                  const Sizes& sizes) {
  const auto n = static_cast<double>(residuals.rows());
  const auto total = static_cast<std::size_t>(residuals.size());
  const auto step = static_cast<Eigen::Index>(std::max<std::size_t>(1, total / most_scores));
  std::vector<double> scores;
  scores.reserve(total / static_cast<std::size_t>(step) + 1);
  for (Eigen::Index i = 0; i < residuals.rows(); ++i) {
    for (Eigen::Index c = i % step; c < residuals.cols(); c += step) {
      const double r = residuals(i, c), own = r / sizes.fitted[i];
      const double others = (n * scale[c] * scale[c] - own * own) / (n - 1);
      if (others > 0) scores.push_back(std::abs(r) / (sizes.left_out[i] * std::sqrt(others)));
    }
  }
  std::sort(scores.begin(), scores.end());
  return scores;
}

/// Logarithm of the sizes as a linear function of the inputs.
struct SizeGrowth {
  std::vector<double> slopes;
  double offset = 0;
  Sizes sizes;
};

/// The penalty is the one of the least leave-one-out error; the largest leaves nearly a constant.
SizeGrowth fit_sizes(const Eigen::VectorXd& sizes, const MatrixD& inputs) {
  const Eigen::VectorXd logarithms = sizes.array().log();
  const math::Standardiser scaler(inputs);
  const std::vector<double> penalties{1, 3, 10, 30, 100, 300, 1e3, 1e4, 1e6};
  const MatrixD x = scaler.apply(inputs);
  const math::Ridge ridge = math::fit_ridge(x, logarithms, penalties);
  SizeGrowth growth;
  growth.sizes.fitted = ridge.predict(x).col(0).array().exp();
  growth.sizes.left_out = (logarithms - ridge.loo_residuals.col(0)).array().exp();
  growth.offset = ridge.intercept[0];
  for (Eigen::Index j = 0; j < inputs.cols(); ++j) {  // in units of the inputs themselves
    growth.slopes.push_back(ridge.weights(j, 0) / scaler.scale()[j]);
    growth.offset -= growth.slopes.back() * scaler.mean()[j];
  }
  return growth;
}

}  // namespace

Uncertainty::Uncertainty(const MatrixF& residuals, std::size_t n_columns, const MatrixD& inputs)
    : n_cases_(static_cast<std::size_t>(residuals.rows())) {
  check(n_columns > 0 && residuals.cols() % static_cast<Eigen::Index>(n_columns) == 0,
        "uncertainty: columns divide the cells");
  check(inputs.size() == 0 || inputs.rows() == residuals.rows(), "uncertainty: inputs of every case");
  if (n_cases_ < 2) throw UsageError("intervals need cross-validated residuals of at least 2 cases");
  Sizes sizes{Eigen::VectorXd::Ones(residuals.rows()), Eigen::VectorXd::Ones(residuals.rows())};
  Eigen::VectorXd scale = root_mean_squares(residuals, sizes.fitted);
  if (inputs.size() > 0) {
    SizeGrowth growth = fit_sizes(sizes_of(residuals, scale), inputs);
    growth_ = std::move(growth.slopes);
    offset_ = growth.offset;
    sizes = std::move(growth.sizes);
    least_ = std::log(sizes.fitted.minCoeff());
    most_ = std::log(sizes.fitted.maxCoeff());
    scale = root_mean_squares(residuals, sizes.fitted);
  }
  const Eigen::VectorXf narrow = scale.cast<float>();
  const auto n_cells = static_cast<std::size_t>(scale.size());
  scale_ = io::Tensor::copy(std::span<const float>(narrow.data(), n_cells), {n_cells / n_columns, n_columns});
  levels_ = table_levels();
  const std::vector<double> scores = pooled_scores(residuals, scale, sizes);
  for (double level : levels_) {
    const auto place = static_cast<std::size_t>(std::ceil(level * static_cast<double>(scores.size())));
    quantiles_.push_back(scores.empty() ? 0 : scores[std::clamp<std::size_t>(place, 1, scores.size()) - 1]);
  }
}

double Uncertainty::factor(std::span<const double> inputs) const {
  if (growth_.empty()) return 1;
  check(inputs.size() == growth_.size(), "uncertainty: one value an input");
  double logarithm = offset_;
  for (std::size_t j = 0; j < inputs.size(); ++j) logarithm += growth_[j] * inputs[j];
  return std::exp(std::clamp(logarithm, least_, most_));
}

double Uncertainty::quantile(double level) const {
  if (!(level > 0 && level < 1)) {
    throw UsageError({.what = "level of a prediction interval",
                      .found = base::number(level),
                      .expected = "above 0, below 1"});
  }
  // Cases, not cells, are the independent samples: their rank decides what level
  // may be promised. The rank is not rounded up: between two ranks the quantile
  // is interpolated, so that the level is met and not exceeded.
  const double n = static_cast<double>(n_cases_);
  const double promised = (n + 1) * level / n;
  if (promised > 1 + 1e-9) {
    throw UsageError({.what = "too few cases for a prediction interval of level " + base::number(level),
                      .found = std::to_string(n_cases_) + " cases",
                      .expected = "at least " + base::number(std::ceil(level / (1 - level) - 1e-9))});
  }
  const auto above =
      static_cast<std::size_t>(std::lower_bound(levels_.begin(), levels_.end(), promised) - levels_.begin());
  if (above == 0) return quantiles_.front();
  const std::size_t at = std::min(above, levels_.size() - 1);
  const double part = (std::min(promised, 1.0) - levels_[at - 1]) / (levels_[at] - levels_[at - 1]);
  return quantiles_[at - 1] + part * (quantiles_[at] - quantiles_[at - 1]);
}

void Uncertainty::scale(std::span<const std::int32_t> planes, std::span<float> out) const {
  check(!scale_.empty(), "uncertainty: made or loaded before use");
  const std::size_t n_columns = scale_.shape()[1];
  check(out.size() == planes.size() * n_columns, "uncertainty: size of the scale asked for");
  for (std::size_t i = 0; i < planes.size(); ++i) {
    check(planes[i] >= 0 && static_cast<std::size_t>(planes[i]) < scale_.shape()[0], "uncertainty: plane");
    std::copy_n(scale_.f32().data() + static_cast<std::size_t>(planes[i]) * n_columns, n_columns,
                out.data() + i * n_columns);
  }
}

void Uncertainty::save(io::TensorFile& file, const std::string& prefix) const {
  file.set_text(prefix, nlohmann::json{{"kind", "cross_conformal"}, {"n_cases", n_cases_}}.dump());
  file.set(prefix + "/scale", scale_);
  file.set(prefix + "/levels", io::Tensor::copy(std::span<const double>(levels_), {levels_.size()}));
  file.set(prefix + "/quantiles", io::Tensor::copy(std::span<const double>(quantiles_), {quantiles_.size()}));
  if (growth_.empty()) return;
  const std::vector<double> range{offset_, least_, most_};
  file.set(prefix + "/growth", io::Tensor::copy(std::span<const double>(growth_), {growth_.size()}));
  file.set(prefix + "/growth_range", io::Tensor::copy(std::span<const double>(range), {range.size()}));
}

Uncertainty Uncertainty::load(const io::TensorFile& file, const std::string& prefix) {
  const std::string where = file.where() + ":" + prefix;
  const nlohmann::json description = read_description(file, prefix);
  if (!description.contains("n_cases") || !description["n_cases"].is_number_unsigned()) {
    throw InputError({.what = "incomplete description of the uncertainty",
                      .where = where,
                      .expected = "a number \"n_cases\""});
  }
  Uncertainty uncertainty;
  uncertainty.n_cases_ = description["n_cases"].get<std::size_t>();
  const std::array<std::size_t, 2> plane{io::any_size, io::any_size};
  uncertainty.scale_ = file.tensor(prefix + "/scale", plane);
  static_cast<void>(uncertainty.scale_.f32());
  const Eigen::VectorXd levels = load_vector(file, prefix + "/levels");
  const Eigen::VectorXd quantiles =
      load_vector(file, prefix + "/quantiles", static_cast<std::size_t>(levels.size()));
  uncertainty.levels_.assign(levels.begin(), levels.end());
  uncertainty.quantiles_.assign(quantiles.begin(), quantiles.end());
  if (file.has(prefix + "/growth")) {
    const Eigen::VectorXd growth = load_vector(file, prefix + "/growth");
    const Eigen::VectorXd range = load_vector(file, prefix + "/growth_range", 3);
    if (!growth.allFinite() || !range.allFinite() || range[1] > range[2])
      throw InputError(
          {.what = "factor of the uncertainty is not usable", .where = where, .expected = "finite numbers"});
    uncertainty.growth_.assign(growth.begin(), growth.end());
    uncertainty.offset_ = range[0];
    uncertainty.least_ = range[1];
    uncertainty.most_ = range[2];
  }
  const bool ascending =
      std::adjacent_find(levels.begin(), levels.end(), std::greater_equal<>()) == levels.end();
  if (uncertainty.n_cases_ == 0 || levels.size() < 2 || !ascending || !quantiles.allFinite()) {
    throw InputError({.what = "table of the uncertainty is not usable",
                      .where = where,
                      .expected = "ascending levels, finite quantiles"});
  }
  return uncertainty;
}

}  // namespace elrom::model
