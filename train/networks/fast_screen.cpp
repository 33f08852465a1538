// The closed-form screen: ridge on random relu features. With the eigenvectors of the
// features' Gram matrix every ridge parameter costs one diagonal, and the error of
// leaving case i out is (I - H_ii)^-1 (y - H y)_i, where block i holds all planes of the
// case (the block form of the leave-one-out residual of any linear smoother).

#include "fast_screen.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "elrom/base/error.hpp"
#include "elrom/base/parallel.hpp"
#include "elrom/math/linear_algebra.hpp"
#include "elrom/networks/screening.hpp"

namespace elrom::networks {
namespace {

constexpr Eigen::Index column_block = 64;
constexpr Eigen::Index probe_stride = 8;                        // every eighth column chooses the ridge
const std::vector<double> ridges{1e-4, 1e-3, 1e-2, 1e-1, 1.0};  // times the mean eigenvalue

// [1, x, relu(A x + b)]: the linear part keeps columns that are linear in the inputs exact.
MatrixF random_features(const MatrixF& inputs, int n_features, base::Seed seed) {
  base::Random random(seed.derive("features"));
  const auto n_in = inputs.cols();
  MatrixF a(n_features, n_in);
  Eigen::RowVectorXf b(n_features);
  const double scale = 1 / std::sqrt(static_cast<double>(std::max<Eigen::Index>(n_in, 1)));
  for (auto& weight : a.reshaped<Eigen::RowMajor>()) weight = static_cast<float>(scale * random.normal());
  for (auto& offset : b) offset = static_cast<float>(random.uniform(-1, 1));
  MatrixF features(inputs.rows(), 1 + n_in + n_features);
  features.col(0).setOnes();
  features.middleCols(1, n_in) = inputs;
  auto hidden = features.rightCols(n_features);
  hidden.noalias() = inputs * a.transpose();
  hidden.rowwise() += b;
  hidden = hidden.cwiseMax(0.0F);
  return features;
}

struct Block {
  std::vector<Eigen::Index> rows;
};

std::vector<Block> case_blocks(const std::vector<std::int32_t>& case_of) {
  std::vector<Block> blocks(static_cast<std::size_t>(*std::ranges::max_element(case_of)) + 1);
  for (std::size_t r = 0; r < case_of.size(); ++r) {
    blocks[static_cast<std::size_t>(case_of[r])].rows.push_back(static_cast<Eigen::Index>(r));
  }
  std::erase_if(blocks, [](const Block& block) { return block.rows.empty(); });
  return blocks;
}

// Features in the basis of the Gram matrix's eigenvectors.
struct Basis {
  MatrixF z;                   //!< (n_records, n_features)
  Eigen::VectorXf eigenvalue;  //!< (n_features)
};

Basis diagonalise(const MatrixF& features, int n_threads, const std::stop_token& stop) {
  const auto n = features.cols();
  Eigen::MatrixXd gram(n, n);
  const auto n_blocks = static_cast<std::size_t>((n + column_block - 1) / column_block);
  const MatrixD wide = features.cast<double>();
  base::parallel_for(
      n_blocks, n_threads,
      [&](std::size_t i, int) {
        const auto first = static_cast<Eigen::Index>(i) * column_block,
                   width = std::min(column_block, n - first);
        gram.middleCols(first, width).noalias() = wide.transpose() * wide.middleCols(first, width);
      },
      stop);
  const math::SymmetricEigen eigen = math::symmetric_eigen(gram);
  const Eigen::MatrixXf vectors = eigen.vectors.cast<float>();
  Basis basis{MatrixF(features.rows(), n), eigen.values.cwiseMax(0.0).cast<float>()};
  base::parallel_for(
      n_blocks, n_threads,
      [&](std::size_t i, int) {
        const auto first = static_cast<Eigen::Index>(i) * column_block,
                   width = std::min(column_block, n - first);
        basis.z.middleCols(first, width).noalias() = features * vectors.middleCols(first, width);
      },
      stop);
  return basis;
}

class LeaveOneCaseOut {
 public:
  LeaveOneCaseOut(const Basis& basis, const std::vector<Block>& blocks, const ScreeningContext& context)
      : basis_(basis), blocks_(blocks), context_(context) {}

  /// Squared leave-one-case-out residuals, (n_records, n_columns).
  [[nodiscard]] MatrixF squared(const MatrixF& targets, double ridge) const {
    const Eigen::VectorXf inverse = (basis_.eigenvalue.array() + static_cast<float>(ridge)).inverse();
    const MatrixF weights = inverse.asDiagonal() * moments(targets);
    MatrixF result(targets.rows(), targets.cols());
    base::parallel_for(
        blocks_.size(), context_.n_threads,
        [&](std::size_t i, int) {
          const auto& rows = blocks_[i].rows;
          const MatrixF z = basis_.z(rows, Eigen::all);
          const MatrixF residual = targets(rows, Eigen::all) - z * weights;
          Eigen::MatrixXf left = Eigen::MatrixXf::Identity(z.rows(), z.rows());
          left.noalias() -= z * inverse.asDiagonal() * z.transpose();
          const MatrixF left_out = left.ldlt().solve(residual);
          result(rows, Eigen::all) = left_out.cwiseAbs2();
        },
        context_.stop);
    return result;
  }

 private:
  MatrixF moments(const MatrixF& targets) const {
    MatrixF moments(basis_.z.cols(), targets.cols());
    const auto n_blocks = static_cast<std::size_t>((targets.cols() + column_block - 1) / column_block);
    base::parallel_for(
        n_blocks, context_.n_threads,
        [&](std::size_t i, int) {
          const auto first = static_cast<Eigen::Index>(i) * column_block;
          const auto width = std::min(column_block, targets.cols() - first);
          moments.middleCols(first, width).noalias() =
              basis_.z.transpose() * targets.middleCols(first, width);
        },
        context_.stop);
    return moments;
  }

  const Basis& basis_;
  const std::vector<Block>& blocks_;
  const ScreeningContext& context_;
};

double chosen_ridge(const LeaveOneCaseOut& smoother, const MatrixF& targets, double mean_eigenvalue) {
  std::vector<Eigen::Index> probes;
  for (Eigen::Index c = 0; c < targets.cols(); c += probe_stride) probes.push_back(c);
  const MatrixF some = targets(Eigen::all, probes);
  double best = HUGE_VAL, ridge = ridges.back() * mean_eigenvalue;
  for (const double relative : ridges) {
    const double error = smoother.squared(some, relative * mean_eigenvalue).cast<double>().mean();
    if (error < best) best = error, ridge = relative * mean_eigenvalue;
  }
  return ridge;
}

}  // namespace

MatrixF leave_one_case_out(const MatrixF& features, const MatrixF& targets,
                           const std::vector<std::int32_t>& case_of, double ridge) {
  const ScreeningContext context;
  const auto basis = diagonalise(features, context.n_threads, context.stop);
  const auto blocks = case_blocks(case_of);
  return LeaveOneCaseOut(basis, blocks, context).squared(targets, ridge);
}

ScreeningResult screen_fast(const ScreeningData& data, const ScreenSettings& settings,
                            const ScreeningContext& context) {
  check(data.inputs.rows() > 0 && data.inputs.rows() == data.targets.rows(), "fast screen: records");
  const auto features = random_features(data.inputs, settings.features, context.seed);
  const auto basis = diagonalise(features, context.n_threads, context.stop);
  const auto blocks = case_blocks(data.case_of);
  const LeaveOneCaseOut smoother(basis, blocks, context);
  const double mean_eigenvalue = std::max(basis.eigenvalue.cast<double>().mean(), 1e-12);
  const MatrixF squared =
      smoother.squared(data.targets, chosen_ridge(smoother, data.targets, mean_eigenvalue));

  ScreeningResult result;
  result.error = MatrixD::Zero(static_cast<Eigen::Index>(data.n_planes), data.targets.cols());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(data.n_planes));
  for (std::size_t r = 0; r < data.plane.size(); ++r) {
    result.error.row(data.plane[r]) += squared.row(static_cast<Eigen::Index>(r)).cast<double>();
    count[data.plane[r]] += 1;
  }
  const auto finite = [](double error) { return error < largest_error ? error : largest_error; };
  result.build_error =
      (result.error.colwise().sum() / static_cast<double>(data.plane.size())).unaryExpr(finite);
  for (Eigen::Index p = 0; p < count.size(); ++p) {
    if (count[p] > 0)
      result.error.row(p) = (result.error.row(p) / count[p]).unaryExpr(finite);
    else
      result.error.row(p) = result.build_error.row(0);
  }
  context.log->progress({context.task, data.targets.cols(), data.targets.cols(), "columns"});
  return result;
}

}  // namespace elrom::networks
