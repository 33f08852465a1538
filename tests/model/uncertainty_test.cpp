#include "elrom/model/uncertainty.hpp"

#include <gmock/gmock.h>

#include <cmath>
#include <numeric>

#include "elrom/base/error.hpp"
#include "elrom/base/random.hpp"

namespace elrom::model {
namespace {

/// Normal residuals; each cell has a standard deviation of its own.
MatrixF normal_residuals(Eigen::Index n_cases, Eigen::Index n_cells, std::uint64_t seed) {
  base::Random random{base::Seed(seed)};
  MatrixF residuals(n_cases, n_cells);
  for (Eigen::Index i = 0; i < n_cases; ++i) {
    for (Eigen::Index c = 0; c < n_cells; ++c)
      residuals(i, c) = static_cast<float>((1.0 + static_cast<double>(c % 7)) * random.normal());
  }
  return residuals;
}

TEST(Uncertainty, CoversFreshCasesAsPromised) {
  const Uncertainty uncertainty(normal_residuals(60, 700, 1), 70);
  const MatrixF fresh = normal_residuals(60, 700, 2);
  std::vector<std::int32_t> planes(10);
  std::iota(planes.begin(), planes.end(), 0);
  std::vector<float> scale(700);
  uncertainty.scale(planes, scale);

  for (const double level : {0.5, 0.8, 0.9, 0.95}) {
    const double factor = uncertainty.quantile(level);
    std::size_t covered = 0;
    for (Eigen::Index i = 0; i < fresh.rows(); ++i) {
      for (Eigen::Index c = 0; c < fresh.cols(); ++c) {
        covered += std::abs(fresh(i, c)) <= factor * scale[static_cast<std::size_t>(c)] ? 1 : 0;
      }
    }
    // 42,000 independent cells: three standard errors of the share are below 0.01; the correction adds 1
    // / 60.
    EXPECT_NEAR(static_cast<double>(covered) / static_cast<double>(fresh.size()), level, 0.025) << level;
  }
}

TEST(Uncertainty, ScaleIsTheRootMeanSquareOfResiduals) {
  MatrixF residuals(2, 2);
  residuals << 3, 1, 4, -1;
  const Uncertainty uncertainty(residuals, 1);
  std::vector<float> scale(2);

  uncertainty.scale(std::vector<std::int32_t>{0, 1}, scale);

  EXPECT_FLOAT_EQ(scale[0], std::sqrt(12.5F));
  EXPECT_FLOAT_EQ(scale[1], 1.0F);
}

TEST(Uncertainty, FollowsTheSizeThatInputsLetExpect) {
  // Errors grow tenfold with the first input; the second one is of no concern.
  constexpr Eigen::Index n_cases = 60, n_cells = 200;
  base::Random random{base::Seed(3)};
  const auto draw = [&](MatrixF& residuals, MatrixD& inputs) {
    for (Eigen::Index i = 0; i < n_cases; ++i) {
      inputs.row(i) << random.uniform(100, 200), random.uniform(-1, 1);
      const double size = std::pow(10.0, (inputs(i, 0) - 100) / 100);
      for (Eigen::Index c = 0; c < n_cells; ++c) residuals(i, c) = static_cast<float>(size * random.normal());
    }
  };
  MatrixF residuals(n_cases, n_cells), fresh(n_cases, n_cells);
  MatrixD inputs(n_cases, 2), asked(n_cases, 2);
  draw(residuals, inputs);
  draw(fresh, asked);
  const Uncertainty uncertainty(residuals, n_cells, inputs);
  std::vector<float> scale(n_cells);
  uncertainty.scale(std::vector<std::int32_t>{0}, scale);

  for (Eigen::Index i = 0; i < n_cases; ++i) {
    const double width = uncertainty.quantile(0.8) * uncertainty.factor({asked.row(i).data(), 2});
    double covered = 0;
    for (Eigen::Index c = 0; c < n_cells; ++c)
      covered += std::abs(fresh(i, c)) <= width * scale[static_cast<std::size_t>(c)] ? 1.0 / n_cells : 0;
    EXPECT_NEAR(covered, 0.8, 0.13) << asked(i, 0);  // four standard errors of 200 cells, and the fit's own
  }
  const std::vector<double> far{1e6, 0}, largest{200, 0};
  EXPECT_LE(uncertainty.factor(far), 1.1 * uncertainty.factor(largest));
}

TEST(Uncertainty, HasOneSizeForAllCasesWhereInputsSayNothing) {
  MatrixD inputs(60, 3);
  base::Random random{base::Seed(4)};
  for (Eigen::Index i = 0; i < inputs.size(); ++i) inputs.data()[i] = random.normal();
  const Uncertainty uncertainty(normal_residuals(60, 300, 5), 300, inputs);

  for (Eigen::Index i = 0; i < 60; ++i) EXPECT_NEAR(uncertainty.factor({inputs.row(i).data(), 3}), 1, 0.08);
}

TEST(Uncertainty, RefusesALevelThatTheCasesCannotPromise) {
  const Uncertainty uncertainty(normal_residuals(9, 20, 1), 20);

  EXPECT_NO_THROW((void)uncertainty.quantile(0.9));
  EXPECT_THROW((void)uncertainty.quantile(0.95), UsageError);
  EXPECT_THROW((void)uncertainty.quantile(0), UsageError);
  EXPECT_THROW((void)uncertainty.quantile(std::nan("")), UsageError);
}

TEST(Uncertainty, IsTheSameAfterSaveAndLoad) {
  MatrixD inputs(20, 1);
  for (Eigen::Index i = 0; i < 20; ++i) inputs(i, 0) = std::sin(static_cast<double>(i));
  const Uncertainty written(normal_residuals(20, 12, 1), 4, inputs);
  io::TensorFile file;
  written.save(file, "u");

  const auto read = Uncertainty::load(file, "u");

  EXPECT_EQ(read.n_cases(), 20U);
  EXPECT_EQ(read.quantile(0.87), written.quantile(0.87));
  const std::vector<double> asked{0.4};
  EXPECT_EQ(read.factor(asked), written.factor(asked));
}

}  // namespace
}  // namespace elrom::model
