#include "elrom/math/cosine_transform.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace elrom::math {
namespace {

TEST(CosineTransform, MatrixIsOrthonormal) {
  const MatrixF c = cosine_matrix(21);

  EXPECT_TRUE((c * c.transpose()).isIdentity(1e-5F));
}

TEST(CosineTransform, HalfOfAnOddLineHasTheOddCoefficientsOfTheWhole) {
  const MatrixF half = cosine_matrix(6, Beyond::negative), whole = cosine_matrix(12);
  const Eigen::VectorXf values = Eigen::VectorXf::LinSpaced(6, 1, 3.5F).cwiseAbs2();
  Eigen::VectorXf line(12);
  line << values, -values.reverse();

  const Eigen::VectorXf coefficients = half * values, of_line = whole * line;

  EXPECT_TRUE((half * half.transpose()).isIdentity(1e-5F));
  for (Eigen::Index k = 0; k < 6; ++k) {
    EXPECT_NEAR(of_line[2 * k], 0, 1e-5);
    EXPECT_NEAR(of_line[2 * k + 1], std::sqrt(2.0F) * coefficients[k], 1e-4);
  }
}

TEST(CosineTransform, ConstantBecomesOneCoefficient) {
  const CosineTransform transform({2, 3, 4});
  std::vector<float> values(24, 5.0F);

  transform.forward(values);

  EXPECT_NEAR(values[0], 5 * std::sqrt(24.0), 1e-4);
  for (std::size_t i = 1; i < values.size(); ++i) EXPECT_NEAR(values[i], 0, 1e-5);
}

TEST(CosineTransform, BackwardUndoesForward) {
  const CosineTransform transform({5, 4, 3});
  std::vector<float> values(60);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(std::sin(static_cast<double>(i * i)));
  const std::vector<float> before = values;

  transform.forward(values);
  transform.backward(values);

  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_NEAR(values[i], before[i], 1e-5);
}

}  // namespace
}  // namespace elrom::math
