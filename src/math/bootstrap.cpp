#include "elrom/math/bootstrap.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::math {
namespace {

/// P(|T| < t) for Student's T.
double student_within(double t, std::size_t n_freedom) {
  const double angle = std::atan(t / std::sqrt(static_cast<double>(n_freedom)));
  const double cosine = std::cos(angle), sine = std::sin(angle);
  const bool odd = n_freedom % 2 == 1;
  double term = odd ? cosine : 1, sum = n_freedom == 1 ? 0 : term;
  for (std::size_t k = odd ? 3 : 2; k + 2 <= n_freedom; k += 2) {
    term *= cosine * cosine * static_cast<double>(k - 1) / static_cast<double>(k);
    sum += term;
  }
  return odd ? 2 / std::numbers::pi * (angle + sine * sum) : sine * sum;
}

double normal_below(double z) { return 0.5 * std::erfc(-z / std::numbers::sqrt2); }

}  // namespace

double student_quantile(double level, std::size_t n_freedom) {
  check(level > 0 && level < 1 && n_freedom >= 1, "student_quantile: a level within 0 and 1");
  double low = 0, high = 1;
  while (student_within(high, n_freedom) < level) high *= 2;
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (student_within(middle, n_freedom) < level ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

std::optional<LikelyRange> bootstrap_interval(std::size_t n_cases, const Figure& figure,
                                              const BootstrapOptions& options) {
  if (n_cases < least_bootstrap_cases) return std::nullopt;
  base::Random random(options.seed.derive("bootstrap"));
  std::vector<std::size_t> drawn(n_cases);
  std::vector<double> figures;
  for (int i = 0; i < options.n_draws; ++i) {
    for (auto& one : drawn) one = static_cast<std::size_t>(random.below(n_cases));
    figures.push_back(figure(drawn));
    if (!std::isfinite(figures.back())) return std::nullopt;
  }
  const auto n = static_cast<double>(n_cases);
  const double tail = normal_below(-std::sqrt(n / (n - 1)) * student_quantile(options.level, n_cases - 1));
  return LikelyRange{quantile(figures, tail), quantile(figures, 1 - tail)};
}

}  // namespace elrom::math
