#include "elrom/math/pod.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "elrom/base/random.hpp"
#include "elrom/math/statistics.hpp"

namespace elrom::math {
namespace {

MatrixF random_snapshots(Eigen::Index n_cases, Eigen::Index n_cells) {
  base::Random random(base::Seed(7).derive("pod"));
  MatrixF values(n_cases, n_cells);
  for (Eigen::Index i = 0; i < values.size(); ++i) values.data()[i] = static_cast<float>(random.normal() + 3);
  return values;
}

TEST(Pod, AllModesReturnTheSnapshots) {
  const MatrixF values = random_snapshots(6, 1500);

  const Pod pod = make_pod(values, all_rows(6));
  const Eigen::MatrixXd back = (pod.coefficients * pod.modes.cast<double>()).rowwise() + pod.mean.transpose();

  EXPECT_EQ(pod.n_modes(), 5U);                                            // six cases less their mean
  EXPECT_LT((back - values.cast<double>()).norm(), 1e-6 * values.norm());  // modes are float32
}

// Waves over the cells and over the cases, neither with a mean: they are orthogonal, so that the sum of their
// products is its own singular value decomposition.
TEST(Pod, FindsTheModesThatSnapshotsWereMadeOf) {
  const Eigen::Index n_cases = 8, n_cells = 700;
  const Eigen::Vector3d singular(30, 7, 2);
  const auto wave = [](Eigen::Index n, Eigen::Index periods) {
    return Eigen::VectorXd(
        Eigen::VectorXd::LinSpaced(n, 0.5, static_cast<double>(n) - 0.5).unaryExpr([&](double at) {
          return std::sqrt(2.0 / static_cast<double>(n)) *
                 std::cos(2 * M_PI * static_cast<double>(periods) * at / static_cast<double>(n));
        }));
  };
  Eigen::MatrixXd values = Eigen::MatrixXd::Constant(n_cases, n_cells, 3);
  for (Eigen::Index k = 0; k < 3; ++k)
    values += singular[k] * wave(n_cases, k + 1) * wave(n_cells, 5 * k + 2).transpose();

  const Pod pod = make_pod(values.cast<float>(), all_rows(static_cast<std::size_t>(n_cases)), {.n_modes = 3});

  const Eigen::MatrixXd modes = pod.modes.cast<double>();
  EXPECT_TRUE((modes * modes.transpose()).isIdentity(1e-5));
  EXPECT_TRUE(pod.energies.head(3).isApprox(singular.cwiseAbs2(), 1e-6));  // snapshots are float32
  for (Eigen::Index k = 0; k < 3; ++k)
    EXPECT_NEAR(std::abs(modes.row(k).dot(wave(n_cells, 5 * k + 2))), 1, 1e-6);
  EXPECT_NEAR(pod.total_energy, singular.squaredNorm(), 1e-6 * pod.total_energy);
}

TEST(Pod, TruncatesByCountAndByEnergy) {
  MatrixF values = MatrixF::Zero(4, 4);
  values.row(0) << 10, 0, 0, 0;
  values.row(1) << -10, 0, 0, 0;
  values.row(2) << 0, 1, 0, 0;
  values.row(3) << 0, -1, 0, 0;  // energies 200 and 2

  EXPECT_EQ(make_pod(values, all_rows(4)).n_modes(), 2U);
  EXPECT_EQ(make_pod(values, all_rows(4), {.n_modes = 1}).n_modes(), 1U);
  EXPECT_EQ(make_pod(values, all_rows(4), {.energy = 0.99}).n_modes(), 1U);  // 200 / 202 = 0.9901
  EXPECT_EQ(make_pod(values, all_rows(4), {.energy = 0.995}).n_modes(), 2U);
}

TEST(Pod, SignsAndBitsDoNotDependOnThreads) {
  const MatrixF values = random_snapshots(6, 9001);

  const Pod one = make_pod(values, all_rows(6), {}, 1), four = make_pod(values, all_rows(6), {}, 4);

  EXPECT_TRUE(one.modes == four.modes);
  EXPECT_TRUE(one.coefficients == four.coefficients);
  for (Eigen::Index m = 0; m < one.modes.rows(); ++m) {
    EXPECT_EQ(one.modes.row(m).maxCoeff(), one.modes.row(m).cwiseAbs().maxCoeff());
  }
}

TEST(Pod, EqualCasesHaveNoModes) {
  EXPECT_EQ(make_pod(MatrixF::Constant(3, 50, 0.1F), all_rows(3)).n_modes(), 0U);
}

TEST(Pod, SmallFluctuationOnALargeMeanIsKept) {
  MatrixF values = MatrixF::Constant(2, 10, 1e6F);
  values(0, 3) += 1;  // 12 digits below the energy of the mean

  const Pod pod = make_pod(values, all_rows(2));

  ASSERT_EQ(pod.n_modes(), 1U);
  EXPECT_NEAR(pod.energies[0], 0.5, 1e-9);
}

}  // namespace
}  // namespace elrom::math
