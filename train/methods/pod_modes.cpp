#include "pod_modes.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "elrom/math/statistics.hpp"

namespace elrom::methods {
namespace {

/// Error of the field with no mode, the first, the first two ... up to the first whose error is not finite.
std::vector<double> errors_of_prefixes(const Eigen::VectorXd& errors, const Eigen::VectorXd& energies) {
  std::vector<double> sums{energies.sum()};
  for (Eigen::Index m = 0; m < errors.size() && std::isfinite(errors[m]); ++m)
    sums.push_back(sums.back() + errors[m] - energies[m]);
  return sums;
}

/// With at least one mode, where there is one.
double least_of(const std::vector<double>& sums) {
  return *std::min_element(sums.begin() + (sums.size() > 1 ? 1 : 0), sums.end());
}

/// A mode costs as many bytes and multiplications as any other: the last ones, which together gain less than
/// this share of the squared error, are not worth theirs.
constexpr double negligible_gain = 1e-3;

}  // namespace

Eigen::Index predictable_modes(const Eigen::VectorXd& errors, const Eigen::VectorXd& energies) {
  const auto sums = errors_of_prefixes(errors, energies);
  const double least = least_of(sums), enough = least + negligible_gain * std::abs(least);
  Eigen::Index n = std::min<Eigen::Index>(1, errors.size());
  while (n + 1 < static_cast<Eigen::Index>(sums.size()) && sums[static_cast<std::size_t>(n)] > enough) ++n;
  return n;
}

double least_error(const Eigen::VectorXd& errors, const Eigen::VectorXd& energies) {
  return least_of(errors_of_prefixes(errors, energies));
}

void keep_modes(math::Pod& pod, Eigen::Index n) {
  pod.modes.conservativeResize(n, Eigen::NoChange);
  pod.coefficients = pod.coefficients.leftCols(n).eval();
  pod.energies.conservativeResize(n);
}

Eigen::VectorXd truncated_deviation(const MatrixF& values, std::span<const std::size_t> rows,
                                    const math::Pod& pod) {
  Eigen::VectorXd variance = math::column_moments(values, rows).deviation.cwiseAbs2();
  for (Eigen::Index m = 0; m < pod.modes.rows(); ++m)
    variance -= pod.modes.row(m).transpose().cast<double>().cwiseAbs2() *
                (pod.energies[m] / static_cast<double>(rows.size()));
  return variance.cwiseMax(0).cwiseSqrt();
}

}  // namespace elrom::methods
