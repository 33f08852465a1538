#pragma once
// What the methods on POD modes share: how many modes a method can predict, and what it leaves out.

#include <Eigen/Core>
#include <span>

#include "elrom/math/pod.hpp"

namespace elrom::methods {

/// The fewest modes, in order of energy, that leave the least error of the field or a thousandth more of its
/// square: of a mode that is kept its error on cases left out, of a mode that is dropped its energy. At least
/// 1, where there is one.
/// @param errors of each mode that was tried, not finite for none @param energies of all modes, at least as
/// many; both as sums or both as means over the cases
[[nodiscard]] Eigen::Index predictable_modes(const Eigen::VectorXd& errors, const Eigen::VectorXd& energies);

/// The error of the field that goes with it: what is kept and what is dropped.
[[nodiscard]] double least_error(const Eigen::VectorXd& errors, const Eigen::VectorXd& energies);

/// Drops all modes but the first n.
void keep_modes(math::Pod& pod, Eigen::Index n);

/// Standard deviation of what the kept modes leave of the rows that the POD was made from, per cell: what
/// varies, less what the modes hold.
[[nodiscard]] Eigen::VectorXd truncated_deviation(const MatrixF& values, std::span<const std::size_t> rows,
                                                  const math::Pod& pod);

}  // namespace elrom::methods
