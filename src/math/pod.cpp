#include "elrom/math/pod.hpp"

#include <algorithm>
#include <vector>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/math/linear_algebra.hpp"

namespace elrom::math {

namespace {

constexpr Eigen::Index block_cells = 512;  // 64 rows of doubles: 256 KiB, inside a second-level cache
constexpr std::size_t n_parts = 16;        // partial sums, the same for every number of threads

struct Range {
  Eigen::Index begin, end;
};

Range part_of(Eigen::Index n_cells, std::size_t part) {
  const auto at = [&](std::size_t i) {
    return std::min(n_cells, (n_cells * static_cast<Eigen::Index>(i) / static_cast<Eigen::Index>(n_parts)));
  };
  return {at(part), at(part + 1)};
}

/// Calls work(part, first cell, rows of the block less the offset (n_rows, n)) for every block of a part.
template <class Work>
void for_blocks(const MatrixF& values, std::span<const std::size_t> rows, const Eigen::VectorXd& offset,
                int n_threads, const Work& work) {
  base::parallel_for(n_parts, n_threads, [&](std::size_t part, int) {
    const Range range = part_of(values.cols(), part);
    MatrixD block;
    for (Eigen::Index begin = range.begin; begin < range.end; begin += block_cells) {
      const Eigen::Index n = std::min(block_cells, range.end - begin);
      block.resize(static_cast<Eigen::Index>(rows.size()), n);
      for (std::size_t i = 0; i < rows.size(); ++i) {
        block.row(static_cast<Eigen::Index>(i)) =
            values.row(static_cast<Eigen::Index>(rows[i])).segment(begin, n).cast<double>() -
            offset.segment(begin, n).transpose();
      }
      work(part, begin, block);
    }
  });
}

/// Eigenvectors that stand for variance, not rounding, within the truncation.
Eigen::Index count_modes(const Eigen::VectorXd& energies, double total, std::size_t n_rows,
                         const PodTruncation& truncation) {
  // Eigenvalues of a Gram matrix are exact to about n * machine epsilon of the largest.
  const double rounding = energies.size() == 0 ? 0 : 1e-14 * static_cast<double>(n_rows) * energies[0];
  double kept = 0;
  Eigen::Index n = 0;
  while (n < energies.size() && energies[n] > rounding) {
    if (truncation.n_modes != 0 && n >= static_cast<Eigen::Index>(truncation.n_modes)) break;
    if (truncation.energy < 1 && kept >= truncation.energy * total) break;
    kept += energies[n++];
  }
  return n;
}

void make_signs_unique(Pod& pod) {
  for (Eigen::Index m = 0; m < pod.modes.rows(); ++m) {
    Eigen::Index at = 0;
    pod.modes.row(m).cwiseAbs().maxCoeff(&at);
    if (pod.modes(m, at) < 0) {
      pod.modes.row(m) *= -1;
      pod.coefficients.col(m) *= -1;
    }
  }
}

}  // namespace

Eigen::VectorXd row_mean(const MatrixF& values, std::span<const std::size_t> rows, int n_threads) {
  check(!rows.empty(), "mean of at least one row");
  Eigen::VectorXd mean(values.cols());
  for_blocks(values, rows, Eigen::VectorXd::Zero(values.cols()), n_threads,
             [&](std::size_t, Eigen::Index begin, const MatrixD& block) {
               mean.segment(begin, block.cols()) = block.colwise().mean().transpose();
             });
  return mean;
}

Eigen::MatrixXd gram(const MatrixF& values, std::span<const std::size_t> rows, const Eigen::VectorXd& offset,
                     int n_threads) {
  const auto n = static_cast<Eigen::Index>(rows.size());
  std::vector<Eigen::MatrixXd> parts(n_parts, Eigen::MatrixXd::Zero(n, n));
  for_blocks(values, rows, offset, n_threads, [&](std::size_t part, Eigen::Index, const MatrixD& block) {
    parts[part].selfadjointView<Eigen::Lower>().rankUpdate(block);
  });
  for (std::size_t part = 1; part < n_parts; ++part) parts[0] += parts[part];
  return parts[0].selfadjointView<Eigen::Lower>();
}

MatrixF combine_rows(const Eigen::MatrixXd& weights, const MatrixF& values, std::span<const std::size_t> rows,
                     const Eigen::VectorXd& offset, int n_threads) {
  MatrixF combined(weights.rows(), values.cols());
  for_blocks(values, rows, offset, n_threads, [&](std::size_t, Eigen::Index begin, const MatrixD& block) {
    const MatrixD product = weights * block;
    combined.middleCols(begin, block.cols()) = product.cast<float>();
  });
  return combined;
}

Pod make_pod(const MatrixF& values, std::span<const std::size_t> rows, const PodTruncation& truncation,
             int n_threads) {
  Pod pod;
  pod.mean = row_mean(values, rows, n_threads);
  const SymmetricEigen eigen = symmetric_eigen(gram(values, rows, pod.mean, n_threads));
  if (!eigen.converged)
    throw NumericalError("POD: the eigenvalues of the cases' Gram matrix did not converge");
  const Eigen::VectorXd energies = eigen.values.reverse().cwiseMax(0);
  pod.total_energy = energies.sum();
  const Eigen::Index n = count_modes(energies, pod.total_energy, rows.size(), truncation);

  pod.energies = energies.head(n);
  const Eigen::VectorXd amplitude = pod.energies.cwiseSqrt();
  const Eigen::MatrixXd vectors = eigen.vectors.rowwise().reverse().leftCols(n);
  pod.coefficients = vectors * amplitude.asDiagonal();
  const Eigen::MatrixXd weights = amplitude.cwiseInverse().asDiagonal() * vectors.transpose();
  pod.modes = combine_rows(weights, values, rows, pod.mean, n_threads);
  make_signs_unique(pod);
  return pod;
}

}  // namespace elrom::math
