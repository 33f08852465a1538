#pragma once
// An interval for a figure that was found on a handful of cases: how far would it move on other cases of the
// same kind? Cases are drawn anew with replacement, the figure is taken of each draw, and quantiles of these
// bound it (percentile bootstrap, Efron & Tibshirani 1993, ch. 13). Of few cases that is too narrow: the
// quantiles are moved outwards to Phi(-sqrt(n / (n - 1)) t), t of Student with n - 1 degrees of freedom, as
// for the mean of a normal sample (Hesterberg 2015, sect. 5.3, "expanded percentile").
//
// Thread rule: pure functions; the same seed gives the same interval.

#include <cstddef>
#include <functional>
#include <optional>
#include <span>

#include "elrom/base/random.hpp"

namespace elrom::math {

struct LikelyRange {
  double low = 0, high = 0;
};

/// Fewer cases give no interval: their draws are next to none.
inline constexpr std::size_t least_bootstrap_cases = 3;

struct BootstrapOptions {
  double level = 0.9;  ///< two-sided
  int n_draws = 4000;
  base::Seed seed{1};
};

/// The figure of the cases named; a case may come more than once.
using Figure = std::function<double(std::span<const std::size_t>)>;

/// Nothing for fewer than least_bootstrap_cases, or where a draw's figure is no number.
[[nodiscard]] std::optional<LikelyRange> bootstrap_interval(std::size_t n_cases, const Figure& figure,
                                                            const BootstrapOptions& options = {});

/// t with P(|T| < t) = level for Student's T of n_freedom >= 1 (Abramowitz & Stegun, 26.7.3 and 26.7.4).
[[nodiscard]] double student_quantile(double level, std::size_t n_freedom);

}  // namespace elrom::math
