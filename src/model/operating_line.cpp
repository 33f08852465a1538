#include "elrom/model/operating_line.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "elrom/base/error.hpp"
#include "elrom/base/text.hpp"
#include "elrom/base/units.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::model {
namespace {

using Row = Eigen::RowVectorXd;

constexpr double constant = 1e-9;         // relative scatter of an input that does not change
constexpr double least_noise = 1e-3;      // of an input's variance, so that no input rules all others
constexpr double least_deviation = 1e-2;  // of an input's scatter: inputs that always moved together
constexpr double least_growth = 0.3;      // far along the line the deviation stays above this share
constexpr double usual_share = 0.025;
constexpr double wanted_limit = 2.3;  // an input 3 deviations off is then found nine times in ten
constexpr double few_for_limit = 8;   // cases that make the wanted limit twice as wide
constexpr double far_beyond = 1.6;    // times the limit
constexpr double never = std::numeric_limits<double>::infinity();

/// One factor for the covariance of standardised inputs.
struct Factor {
  Row loading, noise;

  /// The direction of the largest common scatter, by power iteration, to start from.
  explicit Factor(const Eigen::MatrixXd& covariance) {
    constexpr int n_steps = 100;
    Eigen::Index strongest = 0;
    covariance.colwise().squaredNorm().maxCoeff(&strongest);
    Eigen::VectorXd direction = covariance.col(strongest).normalized();
    for (int i = 0; i < n_steps; ++i) direction = (covariance * direction).normalized();
    const double size = std::sqrt(std::max(0.0, direction.dot(covariance * direction)));
    loading = size * direction.transpose();
    set_noise(covariance, loading);
  }

  void learn(const Eigen::MatrixXd& covariance, int most_steps) {
    constexpr double close = 1e-3;
    for (int step = 0; step < most_steps; ++step) {
      const Row weight = loading.cwiseQuotient(noise);
      const double precision = 1 + loading.dot(weight);
      const Row shared = weight * covariance / precision;  // covariance of the inputs with the factor
      const Row next = shared / (shared.dot(weight) / precision + 1 / precision);
      noise = (covariance.diagonal().transpose() - next.cwiseProduct(shared)).cwiseMax(least_noise);
      const double change = (next - loading).cwiseAbs().maxCoeff();
      loading = next;
      if (change < close) return;
    }
  }

  /// Mean of each standardised input given all the others.
  [[nodiscard]] Row expected(const Row& z) const {
    const Row weight = loading.cwiseQuotient(noise);
    const Row own = z.cwiseProduct(weight);
    return loading.array() * (own.sum() - own.array()) /
           (1 + loading.dot(weight) - loading.cwiseProduct(weight).array());
  }

 private:
  void set_noise(const Eigen::MatrixXd& covariance, const Row& of) {
    noise = (covariance.diagonal().transpose() - of.cwiseAbs2()).cwiseMax(least_noise);
  }
};

/// How the deviation from the line grows along it.
struct ScatterGrowth {
  Row middle, deviation;
  double growth = 0;

  /// @param skip a case to leave out, or -1
  ScatterGrowth(const MatrixD& expected, const MatrixD& left, Eigen::Index skip) {
    const auto sum_without = [&](const auto& values) {
      Row sum = values.colwise().sum();
      if (skip >= 0) sum -= values.row(skip).matrix();
      return sum;
    };
    const double n = static_cast<double>(expected.rows() - (skip >= 0 ? 1 : 0));
    middle = sum_without(expected) / n;
    const auto along = (expected.rowwise() - middle).eval();
    const auto size = left.cwiseAbs().eval();
    const Row mean_size = sum_without(size) / n;
    const double spread = sum_without(along.cwiseAbs2().eval()).dot(mean_size);
    const double slope = sum_without(along.cwiseProduct(size).eval()).sum();  // along sums to nothing
    growth = spread > 0 ? slope / spread : 0;
    const auto scaled = (left.array() / factors(along).array()).square().matrix().eval();
    deviation = (sum_without(scaled) / n).cwiseSqrt().cwiseMax(least_deviation);
  }

  [[nodiscard]] MatrixD factors(const MatrixD& along) const {
    return (1 + growth * along.array()).max(least_growth);
  }
  [[nodiscard]] Row at(const Row& expected) const {
    return deviation.array() * (1 + growth * (expected - middle).array()).max(least_growth);
  }
};

double limit_of(std::vector<double> farthest, std::size_t most_beyond) {
  std::ranges::sort(farthest);
  const auto n = farthest.size();
  const double least = farthest[n - 1 - std::min(most_beyond, n - 1)];  // not more cases exceed it
  const double usual = std::min(math::conformal_quantile(farthest, 1 - usual_share), farthest.back());
  return std::min(usual, std::max(wanted_limit * growth_for_few(n, few_for_limit), least));
}

}  // namespace

struct OperatingLine::Learned {
  Eigen::Index n_inputs = 0;
  std::vector<Eigen::Index> varying;  //!< inputs that change; all below is of these
  Row mean, scale;                    //!< to standardise
  Factor factor;
  ScatterGrowth growth;
  MatrixD expected, left;  //!< of the learned cases by the others, standardised

  [[nodiscard]] std::vector<UsualInput> spread_out(const Row& value, const Row& deviation) const {
    std::vector<UsualInput> result(static_cast<std::size_t>(n_inputs), {0, never});
    for (std::size_t k = 0; k < varying.size(); ++k) {
      const auto j = static_cast<Eigen::Index>(k);
      result[static_cast<std::size_t>(varying[k])] = {mean[j] + scale[j] * value[j], scale[j] * deviation[j]};
    }
    return result;
  }
};

std::size_t most_flagged(std::size_t n_cases) {
  const double most = std::floor(most_flagged_share * static_cast<double>(n_cases + 1)) - 1;
  return most > 0 ? static_cast<std::size_t>(most) : 0;
}

double growth_for_few(std::size_t n_cases, double few) {
  const double share = few / static_cast<double>(n_cases);
  return 1 + share * share;
}

double UsualInput::distance(double given) const {
  return std::isfinite(deviation) ? std::abs(given - value) / deviation : 0;
}

OperatingLine::OperatingLine(const MatrixD& inputs, std::size_t n_flagged) {
  if (static_cast<std::size_t>(inputs.rows()) < fewest_cases) return;
  const Row mean = inputs.colwise().mean();
  const Row scale = (inputs.rowwise() - mean).cwiseAbs2().colwise().mean().cwiseSqrt();
  std::vector<Eigen::Index> varying;
  for (Eigen::Index i = 0; i < inputs.cols(); ++i)
    if (scale[i] > constant * std::abs(mean[i])) varying.push_back(i);
  if (varying.size() < 2) return;
  const Row own_mean = mean(varying), own_scale = scale(varying);
  const MatrixD z =
      (inputs(Eigen::all, varying).rowwise() - own_mean) * own_scale.cwiseInverse().asDiagonal();
  const auto n = static_cast<double>(z.rows());
  const Eigen::MatrixXd covariance = z.transpose() * z / n;
  constexpr int most_steps = 500, most_steps_again = 20;
  Factor factor(covariance);
  factor.learn(covariance, most_steps);
  MatrixD expected(z.rows(), z.cols());
  for (Eigen::Index i = 0; i < z.rows(); ++i) {
    const Row shift = -z.row(i) / (n - 1);  // the mean of the others
    auto others = factor;
    others.learn((n * covariance - z.row(i).transpose() * z.row(i)) / (n - 1) - shift.transpose() * shift,
                 most_steps_again);
    expected.row(i) = others.expected(z.row(i) - shift) + shift;
  }
  const MatrixD left = z - expected;
  learned_ = std::make_shared<const Learned>(Learned{inputs.cols(), varying, own_mean, own_scale, factor,
                                                     ScatterGrowth(expected, left, -1), expected, left});
  std::vector<double> farthest;
  for (Eigen::Index i = 0; i < left.rows(); ++i) {
    const Row deviation = ScatterGrowth(expected, left, i).at(expected.row(i));
    farthest.push_back(left.row(i).cwiseQuotient(deviation).cwiseAbs().maxCoeff());
  }
  const auto most = most_flagged(farthest.size());
  limit_ = limit_of(std::move(farthest), most - std::min(most, n_flagged));
}

double OperatingLine::far_limit() const {
  return knows() ? far_beyond * growth_for_few(static_cast<std::size_t>(learned_->left.rows())) * limit_
                 : never;
}

std::vector<UsualInput> OperatingLine::usual(std::span<const double> inputs) const {
  if (!knows()) return std::vector<UsualInput>(inputs.size(), {0, never});
  const auto& known = *learned_;
  check(static_cast<Eigen::Index>(inputs.size()) == known.n_inputs, "operating line: one value an input");
  const Eigen::Map<const Row> point(inputs.data(), known.n_inputs);
  const Row z = (point(known.varying) - known.mean).cwiseQuotient(known.scale);
  const Row expected = known.factor.expected(z);
  return known.spread_out(expected, known.growth.at(expected));
}

std::vector<UsualInput> OperatingLine::left_out(std::size_t i_case) const {
  check(knows(), "operating line: learned from enough cases");
  const auto i = static_cast<Eigen::Index>(i_case);
  const Row expected = learned_->expected.row(i);
  return learned_->spread_out(expected, ScatterGrowth(learned_->expected, learned_->left, i).at(expected));
}

std::string unusual_text(const field::InputInfo& info, double given, const UsualInput& usual) {
  const auto& unit = base::unit(info.display_unit.empty() ? info.unit : info.display_unit);
  const double deviation = usual.deviation / unit.factor;
  const int decimals = std::clamp(1 - static_cast<int>(std::floor(std::log10(deviation))), 0, 9);
  return fmt::format("{} {} {}: {:.{}f} +- {:.{}f} {} is usual with these other inputs", info.name,
                     base::rounded(unit.from_si(given)), unit.symbol, unit.from_si(usual.value), decimals,
                     deviation, decimals, unit.symbol);
}

}  // namespace elrom::model
