#include "pod_modes.hpp"

#include <cmath>

#include "elrom/math/statistics.hpp"

namespace elrom::methods {
namespace {

struct Prefix {
  Eigen::Index n = 0;
  double error = 0;
};

Prefix best_prefix(const Eigen::VectorXd& errors, const Eigen::VectorXd& energies) {
  double error = energies.sum();
  Prefix best{0, error};
  for (Eigen::Index m = 0; m < errors.size() && std::isfinite(errors[m]); ++m) {
    error += errors[m] - energies[m];
    if (m == 0 || error < best.error) best = {m + 1, error};
  }
  return best;
}

}  // namespace

Eigen::Index predictable_modes(const Eigen::VectorXd& errors, const Eigen::VectorXd& energies) {
  return std::max<Eigen::Index>(best_prefix(errors, energies).n, std::min<Eigen::Index>(1, errors.size()));
}

double least_error(const Eigen::VectorXd& errors, const Eigen::VectorXd& energies) {
  return best_prefix(errors, energies).error;
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
