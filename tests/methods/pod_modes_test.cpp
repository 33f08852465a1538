#include "pod_modes.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace elrom::methods {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

TEST(PodModes, KeepsTheFirstModesThatLeaveTheLeastError) {
  const VectorXd energies = (VectorXd(4) << 10, 4, 2, 1).finished();
  // Left after 1, 2, 3 modes: 8, 9, 6.5; the second alone costs, with the third behind it it pays.
  EXPECT_EQ(predictable_modes(Vector3d(1, 5, -0.5), energies), 3);
  EXPECT_DOUBLE_EQ(least_error(Vector3d(1, 5, -0.5), energies), 6.5);
  EXPECT_EQ(predictable_modes(Vector3d(1, 5, 2.5), energies), 1);
}

TEST(PodModes, LastModesThatTogetherGainNextToNothingAreNotKept) {
  const VectorXd energies = (VectorXd(4) << 10, 1, 1e-3, 3e-4).finished();
  EXPECT_EQ(predictable_modes(VectorXd((VectorXd(4) << 1, 0.5, 0, 0).finished()), energies), 2);
  EXPECT_EQ(predictable_modes(VectorXd((VectorXd(4) << 1e-3, 0, 0, 0).finished()), energies), 4);
}

TEST(PodModes, OneModeStaysWhereNoneCanBePredicted) {
  const VectorXd energies = Vector3d(3, 2, 1);
  EXPECT_EQ(predictable_modes(Vector3d(4, 3, 2), energies), 1);
  EXPECT_EQ(predictable_modes(Vector3d::Constant(std::numeric_limits<double>::infinity()), energies), 1);
}

TEST(PodModes, WhatIsDroppedIsNoLongerThere) {
  MatrixF values(4, 6);
  for (Eigen::Index i = 0; i < 4; ++i)
    for (Eigen::Index c = 0; c < 6; ++c) values(i, c) = static_cast<float>((i * i + 2 * c * i + c) % 7);
  const std::vector<std::size_t> rows{0, 1, 2, 3};
  auto pod = math::make_pod(values, rows);
  const auto first = math::make_pod(values, rows, {.n_modes = 1});

  EXPECT_LT(truncated_deviation(values, rows, pod).maxCoeff(), 1e-3);  // rounding of floats
  keep_modes(pod, 1);

  EXPECT_TRUE(pod.modes.isApprox(first.modes));
  EXPECT_TRUE(pod.coefficients.isApprox(first.coefficients));
  EXPECT_TRUE(truncated_deviation(values, rows, pod).isApprox(truncated_deviation(values, rows, first)));
}

}  // namespace
}  // namespace elrom::methods
