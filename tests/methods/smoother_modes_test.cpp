#include "smoother_modes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "elrom/base/random.hpp"
#include "leave_one_out.hpp"

namespace elrom::methods {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

model::SmootherKernel kernel_with_noise(double noise) {
  return {.covariance = math::Covariance::gaussian,
          .linear = 0.1,
          .constant = 100,
          .noise = noise,
          .inverse_lengths = VectorXd::Constant(2, 0.7),
          .imbalance = VectorXd::Zero(2)};
}

/// Cases that vary smoothly in one direction, and less in a second one, with noise in 300 cells.
struct TwoModes {
  MatrixD z{50, 2};
  VectorXd strong{50};
  MatrixXd gram;

  explicit TwoModes(double signal) {
    base::Random random(base::Seed(7));
    MatrixXd cases(50, 300);
    for (Index i = 0; i < 50; ++i) {
      z.row(i) << random.uniform(-1.7, 1.7), random.uniform(-1.7, 1.7);
      for (Index c = 0; c < 300; ++c) cases(i, c) = random.normal();
      strong[i] = signal * std::sin(z(i, 0));
      cases(i, 0) += strong[i];
      cases(i, 1) += 0.3 * signal * std::cos(1.5 * z(i, 1));
    }
    cases.rowwise() -= cases.colwise().mean().eval();
    strong.array() -= strong.mean();
    gram = cases * cases.transpose();
  }
};

TEST(SmootherModes, AreOrthonormalAndNoMoreThanAllowed) {
  const TwoModes world(30);

  const auto modes = modes_of(kernel_with_noise(1), world.z, world.gram, {.most = 5, .own = 2}, 1);

  ASSERT_EQ(modes.basis.rows(), 5);
  EXPECT_TRUE((modes.basis * world.gram * modes.basis.transpose()).isIdentity(1e-8));
  EXPECT_EQ(modes.own_kernels.size(), 2U);
}

TEST(SmootherModes, PureNoiseHasHardlyAnySignal) {
  const TwoModes world(0);

  const auto modes = modes_of(kernel_with_noise(1), world.z, world.gram, {.most = 3}, 1);

  const MatrixXd with_noise = world.gram * modes.basis.transpose();
  EXPECT_LT(modes.targets.squaredNorm(), 0.3 * with_noise.squaredNorm());
}

TEST(SmootherModes, ACaseThatIsAllSignalKeepsItsProductWithItself) {
  TwoModes world(30);
  world.gram = world.strong * world.strong.transpose();

  const auto modes = modes_of(kernel_with_noise(1e-6), world.z, world.gram, {.most = 1}, 1);

  EXPECT_TRUE(modes.targets.isApprox(world.gram * modes.basis.transpose(), 1e-3));
}

TEST(SmootherModes, ALeadingModeHasLessNoiseThanTheField) {
  const TwoModes world(100);

  const auto modes = modes_of(kernel_with_noise(0.1), world.z, world.gram, {.most = 3}, 1);

  ASSERT_EQ(modes.own_kernels.size(), 2U) << "the last mode has the field's";
  EXPECT_LT(modes.own_kernels[0].noise, 0.02);
}

TEST(SmootherModes, GroupsHoldEveryModeOnceAndTheLastTheCommonKernel) {
  const TwoModes world(30);
  const auto common = kernel_with_noise(0.1);
  const auto modes = modes_of(common, world.z, world.gram, {.most = 5, .own = 2}, 1);
  std::vector<Index> begins, sizes;
  double last_noise = 0;

  modes.each_group(common, [&](const model::SmootherKernel& kernel, Index first, Index n) {
    begins.push_back(first);
    sizes.push_back(n);
    last_noise = kernel.noise;
  });

  EXPECT_EQ(begins, (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(sizes, (std::vector<Index>{1, 1, 3}));
  EXPECT_EQ(last_noise, common.noise);
}

TEST(SmootherModes, AnAntisymmetricPartHasOneKernel) {
  const TwoModes world(30);
  auto kernel = kernel_with_noise(0.1);
  kernel.antisymmetric = true;
  kernel.imbalance.setOnes();

  EXPECT_TRUE(modes_of(kernel, world.z, world.gram, {.most = 5}, 1).own_kernels.empty());
}

TEST(ModeKernel, StaysWithTheFieldWhereTwoCasesSayNothing) {
  const auto field = kernel_with_noise(0.1);
  const MatrixD z = MatrixD::Random(2, 2);

  const auto own = fit_mode_kernel(z, Eigen::Vector2d(1, -1), field);

  EXPECT_TRUE(own.inverse_lengths.isApprox(field.inverse_lengths, 0.2));
  EXPECT_NEAR(std::log(own.noise / field.noise), 0, 1);
}

TEST(ModeKernel, FindsTheNoiseOfItsMode) {
  base::Random random(base::Seed(2));
  const auto field = kernel_with_noise(0.1);
  MatrixD z(80, 2);
  VectorXd smooth(80), rough(80);
  for (Index i = 0; i < 80; ++i) {
    z.row(i) << random.uniform(-2, 2), random.uniform(-2, 2);
    smooth[i] = std::sin(z(i, 0)) + 0.5 * z(i, 1);
    rough[i] = smooth[i] + 2 * random.normal();
  }

  EXPECT_LT(fit_mode_kernel(z, smooth, field).noise, 0.1 * field.noise);
  EXPECT_GT(fit_mode_kernel(z, rough, field).noise, 2 * field.noise);
}

}  // namespace
}  // namespace elrom::methods
