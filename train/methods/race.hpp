#pragma once
// A contest of candidates as a race: in which folds they are tried, and when one leaves. Internal to methods.

#include <Eigen/Core>
#include <vector>

namespace elrom::methods {

/// A member of a blend with less weight costs more to evaluate than it gives.
inline constexpr double negligible_weight = 0.1;

/// Numbers of the folds of each round: the middle one, then every third, then the rest.
[[nodiscard]] std::vector<std::vector<std::size_t>> rounds_of(std::size_t n_folds);

/// A candidate beside the blend of those before it, by bands of columns: b are the blend's errors of one
/// case, d the candidate's less those.
struct Shown {
  Eigen::MatrixXd gains;       ///< -b.d, (n_cases, n_bands)
  Eigen::VectorXd departures;  ///< d.d, summed over the cases, (n_bands)
  double squares = 0;          ///< b.b, summed over cases and bands
};

/// Whether a candidate may move the answer. With weight w it lowers the squared error of the blend by
/// 2 w x - w^2 d.d, where x = -b.d; the best weight is x / d.d. The gains of x as large as chance allows, in
/// each band that would give the candidate more than a negligible weight, are together compared with the gain
/// that the answer would follow by no more than a negligible share.
/// @param full_gain of the error that the answer follows all the way
[[nodiscard]] bool may_gain(const Shown& shown, double full_gain);

}  // namespace elrom::methods
