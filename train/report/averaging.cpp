// What longer averaging buys, and both ways to a lower error beside each other.

#include <fmt/format.h>

#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/report/learning_curve.hpp"
#include "elrom/report/metrics.hpp"
#include "names.hpp"

namespace elrom::report {

AveragingCurve fit_averaging(const std::vector<std::string>& fields, const std::vector<double>& levels,
                             const MatrixD& shares) {
  check(shares.rows() == static_cast<Eigen::Index>(fields.size()) &&
            shares.cols() == static_cast<Eigen::Index>(levels.size()) && levels.size() >= 2,
        "fit_averaging: a share for each field and level, of two levels at least");
  AveragingCurve curve;
  const auto s = Eigen::Map<const Eigen::RowVectorXd>(levels.data(), shares.cols());
  // Through the first point, which no drawn noise moves.
  const Eigen::RowVectorXd added = s.array() - s(0);
  for (Eigen::Index f = 0; f < shares.rows(); ++f) {
    const double first = shares(f, 0);
    const double noise = (shares.row(f).array() - first).matrix().dot(added) / added.squaredNorm();
    curve.fields[fields[static_cast<std::size_t>(f)]] = {first - noise * s(0), noise};
  }
  for (Eigen::Index level = 0; level < shares.cols(); ++level)
    curve.levels.push_back(
        {s(level), shares.col(level).unaryExpr([](double share) { return signed_nrmse(share, 1); }).mean()});
  return curve;
}

double AveragingCurve::at(double factor) const {
  double sum = 0;
  for (const auto& [name, field] : fields) sum += signed_nrmse(field.clean + field.noise / factor, 1);
  return sum / static_cast<double>(fields.size());
}

std::optional<double> AveragingCurve::factor_for(double error) const {
  if (fields.empty() || at(HUGE_VAL) >= error) return {};
  double low = 0, high = 1;  // of 1 / factor, in which the error rises
  if (at(1) <= error) return 1;
  for (int halving = 0; halving < 60; ++halving) {
    const double middle = (low + high) / 2;
    (at(1 / middle) > error ? high : low) = middle;
  }
  return 1 / low;
}

std::vector<Purchase> purchases(const LearningCurve& curve, std::vector<double> wanted) {
  if (!curve.has_averaged_truth()) return {};
  if (wanted.empty())
    for (const double below : {0.1, 0.2, 0.3, 0.5}) wanted.push_back((1 - below) * curve.v2.averaged_mean);
  const auto within = [](std::optional<double> value, double most) {
    return value && *value <= most ? value : std::nullopt;
  };
  std::vector<Purchase> result;
  for (const double error : wanted)
    result.push_back({error,
                      within(curve.averaged_fit.cases_for(error),
                             Purchase::farthest * static_cast<double>(curve.v2.cases)),
                      within(curve.averaging.factor_for(error), Purchase::farthest)});
  return result;
}

double hours_of_cases(const LearningCurve& curve, double cases) {
  const double further = std::max(0.0, std::ceil(cases) - static_cast<double>(curve.v2.cases));
  return curve.price.hours > 0 ? further * curve.price.hours : undefined;
}

double hours_of_averaging(const LearningCurve& curve, double factor) {
  const double averaging = curve.price.hours - curve.price.start_up;
  return curve.price.hours > 0 ? static_cast<double>(curve.v2.cases) * averaging * (factor - 1) : undefined;
}

namespace {

std::string hours_text(double hours) { return std::isfinite(hours) ? fmt::format("{:.0f} h", hours) : ""; }

}  // namespace

std::string purchase_table(const LearningCurve& curve, const std::vector<double>& wanted) {
  if (!curve.has_averaged_truth())
    return "  What longer averaging would buy is not known: not every held-out case has repeated runs.\n";
  auto text = fmt::format(
      "\n  What lowers the error against averaged truths, {} now, by further hours of {}\n\n  {:>10}  {:>22}  "
      "{:>28}\n  {}\n",
      score_text(curve.v2.averaged_mean), curve.price.name, "mean NRMSE", "more cases",
      "each case averaged longer", std::string(64, '-'));
  for (const auto& way : purchases(curve, wanted)) {
    const auto cases = way.cases ? fmt::format("{:.0f} in all {:>10}", std::ceil(*way.cases),
                                               hours_text(hours_of_cases(curve, *way.cases)))
                                 : "not told";
    const auto longer = way.averaging ? fmt::format("{:.1f} times {:>10}", *way.averaging,
                                                    hours_text(hours_of_averaging(curve, *way.averaging)))
                                      : "not told";
    text += fmt::format("  {:>10}  {:>22}  {:>28}\n", score_text(way.error), cases, longer);
  }
  return text +
         fmt::format(
             "  Averaged for ever: {}. Not told: beyond {:.0f} times what there is, or below what the curve "
             "reaches.\n  Longer averaging by noise added to the training cases, drawn back to less: at "
             "least so much.\n",
             score_text(curve.averaging.at(HUGE_VAL)), Purchase::farthest);
}

}  // namespace elrom::report
